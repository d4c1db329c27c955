// Which instruction set's kernels run.
#pragma once
#include "kernels/kernels.h"
#include "vitral/render.h"

#include <vector>

namespace vitral {

// The widest that this processor runs, or the one asked for. Throws UsageError when the processor (or
// the build) lacks it. Every choice gives the same picture.
const Kernels& choose_kernels(Isa isa);

// All that this processor runs, narrowest first.
std::vector<const Kernels*> available_kernels();

}  // namespace vitral
