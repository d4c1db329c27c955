// What `vitral bench` prints.
#pragma once
#include "app/job.h"
#include "app/options.h"
#include "render/measure.h"

#include <string>
#include <vector>

namespace vitral {

double median(std::vector<double> values);  // of one value or more

// "INPUT: 12 triangles, 64x64, 2 threads, avx2", without an end of line.
std::string bench_title(const Job& job, const std::string& isa, int threads);

// Every pass: as a table, and as JSON.
std::string passes_table(const Job& job, const Measurement& measurement, int repeat);
std::string passes_json(const Job& job, const Measurement& measurement);

// The frames of --report: for every camera each choice of effects, then for the first camera ambient
// occlusion alone with more and more samples. The tables expect their times in the same order.
std::vector<FrameJob> report_jobs(const std::vector<Camera>& cameras, const Settings& settings);
std::string report_tables(const Job& job, const std::vector<Camera>& cameras, const Runs& runs,
                          const FramesMeasured& measured);

}  // namespace vitral
