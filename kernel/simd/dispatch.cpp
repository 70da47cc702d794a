#include <xsimd/xsimd.hpp>

#include "kernels.hpp"

namespace plumb {

bool is_supported(Isa isa) {
  static const auto available = xsimd::available_architectures();
  switch (isa) {
    case Isa::scalar:
      return true;
    case Isa::sse2:
      return available.sse2;
    case Isa::avx2:
      return available.avx2 && available.fma3_avx2;
    case Isa::avx512:
      return available.avx512bw && available.avx512dq && available.avx512cd &&
             __builtin_cpu_supports("avx512vl");
  }
  return false;
}

Isa best_isa() {
  for (const Isa isa : {Isa::avx512, Isa::avx2, Isa::sse2})
    if (is_supported(isa)) return isa;
  return Isa::scalar;
}

namespace simd {

template <>
const Kernels<float>& kernels<float>(Isa isa) {
  const Kernels<float>* const tables[] = {&scalar_float, &sse2_float, &avx2_float, &avx512_float};
  return *tables[static_cast<int>(isa)];
}

template <>
const Kernels<double>& kernels<double>(Isa isa) {
  const Kernels<double>* const tables[] = {&scalar_double, &sse2_double, &avx2_double, &avx512_double};
  return *tables[static_cast<int>(isa)];
}

}  // namespace simd
}  // namespace plumb
