#include <algorithm>
#include <array>
#include <iterator>

#include "simd/front/front_kernels.hpp"
#include "simd/kkt/kkt_kernels.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "simd/tree/tree_kernels.hpp"

#if defined(__x86_64__) || defined(__i386__)
#include <xsimd/xsimd.hpp>
#define PLUMB_LOOK_AT_PROCESSOR [[maybe_unused]] static const auto cpu = xsimd::available_architectures();
#else
#define PLUMB_LOOK_AT_PROCESSOR
#endif

namespace plumb {
namespace {

struct Name {
  Isa isa;
  std::string_view name;
};
constexpr Name names[] = {{Isa::scalar, "scalar"}, {Isa::sse2, "sse2"}, {Isa::avx2, "avx2"},
                          {Isa::avx512, "avx512"}, {Isa::neon, "neon"}, {Isa::simd128, "simd128"}};
constexpr auto isas = [] {
  std::array<Isa, std::size(names)> all{};
  std::transform(std::begin(names), std::end(names), all.begin(), [](const Name& n) { return n.isa; });
  return all;
}();

/// What this build holds of an instruction set.
struct Row {
  Isa isa;
  bool (*is_supported)();
  const simd::Kernels<float>* floats;
  const simd::Kernels<double>* doubles;
  const simd::TreeKernels<float>* tree_floats;
  const simd::TreeKernels<double>* tree_doubles;
  const simd::FrontKernels* fronts;
  const simd::KktKernels* kkts;
};

#define PLUMB_ROW(isa, supported)         \
  {Isa::isa,                              \
   [] {                                   \
     PLUMB_LOOK_AT_PROCESSOR              \
     return static_cast<bool>(supported); \
   },                                     \
   &simd::relax_##isa##_float,            \
   &simd::relax_##isa##_double,           \
   &simd::tree_##isa##_float,             \
   &simd::tree_##isa##_double,            \
   &simd::front_##isa,                    \
   &simd::kkt_##isa},
constexpr Row rows[] = {PLUMB_FOR_EACH_ISA(PLUMB_ROW)};
#undef PLUMB_ROW
#undef PLUMB_LOOK_AT_PROCESSOR

/// Null for a value that is no Isa of this build.
const Row* find_row(Isa isa) {
  const auto row = std::find_if(std::begin(rows), std::end(rows), [&](const Row& r) { return r.isa == isa; });
  return row == std::end(rows) ? nullptr : row;
}

}  // namespace

std::span<const Isa> all_isas() {
  return isas;
}

bool is_supported(Isa isa) {
  const Row* const row = find_row(isa);
  return row && row->is_supported();
}

Isa best_isa() {
  return *std::find_if(std::rbegin(isas), std::rend(isas), is_supported);
}

std::string_view to_string(Isa isa) {
  const auto name =
      std::find_if(std::begin(names), std::end(names), [&](const Name& n) { return n.isa == isa; });
  return name == std::end(names) ? "unknown" : name->name;
}

namespace simd {

template <>
const Kernels<float>& kernels<float>(Isa isa) {
  return *find_row(isa)->floats;
}

template <>
const Kernels<double>& kernels<double>(Isa isa) {
  return *find_row(isa)->doubles;
}

template <>
const TreeKernels<float>& tree_kernels<float>(Isa isa) {
  return *find_row(isa)->tree_floats;
}

template <>
const TreeKernels<double>& tree_kernels<double>(Isa isa) {
  return *find_row(isa)->tree_doubles;
}

const FrontKernels& front_kernels(Isa isa) {
  return *find_row(isa)->fronts;
}

const KktKernels& kkt_kernels(Isa isa) {
  return *find_row(isa)->kkts;
}

}  // namespace simd
}  // namespace plumb
