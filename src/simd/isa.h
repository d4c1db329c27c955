// The instruction sets that were built, and which of them this processor has.
#pragma once

// Calls the macro X for each name; the list is the Makefile's.
#ifndef VITRAL_FOR_EACH_ISA
#define VITRAL_FOR_EACH_ISA(X) X(scalar)
#endif

namespace vitral {

// True when this processor and its operating system run code built for the instruction set `name`.
// The one place that asks the processor.
bool cpu_runs(const char* name);

}  // namespace vitral
