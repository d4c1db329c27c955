// The commands of the program. Each returns the exit code, or throws what main() turns into one.
#pragma once
#include "app/job.h"
#include "app/options.h"
#include "vitral/render.h"

#include <string>
#include <string_view>
#include <vector>

namespace vitral {

enum ExitCode : int {
  kDone = 0,
  kFailed = 1,
  kDifferent = 1,
  kWrongUsage = 2,
  kTrouble = 2,
  kInterrupted = 130
};

int run_render(const Options& options);
int run_bench(const Options& options);
int run_info(const Options& options);
int run_diff(const Options& options);

// Prints the warnings, each on a line of standard error, and forgets them.
void report_warnings(Warnings& warnings, const Options& options);

// Throws when `path` cannot be written, is one of the inputs, or is "-" and a terminal.
void check_output(const std::string& path, const std::vector<std::string>& inputs);

// Prints to standard output and makes sure that it arrived. Throws InputError.
void print(std::string_view text);

// What --stats writes. The time of writing includes the encoding, but in the statistics not the
// writing of the picture, which comes after them.
struct RunTimes {
  double load_seconds = 0, render_seconds = 0, write_seconds = 0;
};
std::string stats_json(const Job& job, const Stats& stats, const RunTimes& times);

}  // namespace vitral
