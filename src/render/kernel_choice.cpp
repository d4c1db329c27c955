#include "render/kernel_choice.h"

#include "simd/isa.h"
#include "vitral/error.h"

#include <string>

namespace vitral {

std::vector<const Kernels*> available_kernels() {
  std::vector<const Kernels*> found;
#define VITRAL_ADD(isa) \
  if (cpu_runs(#isa)) found.push_back(&isa::kTable);
  VITRAL_FOR_EACH_ISA(VITRAL_ADD)
#undef VITRAL_ADD
  return found;
}

const Kernels& choose_kernels(Isa isa) {
  const std::vector<const Kernels*> found = available_kernels();
  if (isa == Isa::automatic) return *found.back();
  const char* const names[] = {"auto", "scalar", "v2", "avx2", "avx512"};
  const std::string name = names[static_cast<size_t>(isa)];
  for (const Kernels* k : found) {
    if (name == k->isa) return *k;
  }
  throw UsageError("this processor cannot run the instruction set '" + name + "'");
}

}  // namespace vitral
