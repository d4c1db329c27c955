// The list of instruction sets, once. A build for another processor than x86-64 has only `scalar`.
#pragma once

#if defined(__x86_64__)
#define VITRAL_FOR_EACH_ISA(X) X(scalar) X(v2) X(avx2) X(avx512)
#else
#define VITRAL_FOR_EACH_ISA(X) X(scalar)
#endif

namespace vitral {

// True when this processor and its operating system run code built for the instruction set `name`.
// The one place that asks the processor.
bool cpu_runs(const char* name);

}  // namespace vitral
