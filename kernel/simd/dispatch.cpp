#include <algorithm>
#include <iterator>
#include <xsimd/xsimd.hpp>

#include "simd/front/front_kernels.hpp"
#include "simd/kkt/kkt_kernels.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "simd/tree/tree_kernels.hpp"

namespace plumb {
namespace {

struct Row {
  Isa isa;
  std::string_view name;
  bool (*is_supported)();
  const simd::Kernels<float>* floats;
  const simd::Kernels<double>* doubles;
  const simd::TreeKernels<float>* tree_floats;
  const simd::TreeKernels<double>* tree_doubles;
  const simd::FrontKernels* fronts;
  const simd::KktKernels* kkts;
};

#define PLUMB_ROW(isa, supported)                                               \
  {Isa::isa,                                                                    \
   #isa,                                                                        \
   [] {                                                                         \
     [[maybe_unused]] static const auto cpu = xsimd::available_architectures(); \
     return static_cast<bool>(supported);                                       \
   },                                                                           \
   &simd::relax_##isa##_float,                                                  \
   &simd::relax_##isa##_double,                                                 \
   &simd::tree_##isa##_float,                                                   \
   &simd::tree_##isa##_double,                                                  \
   &simd::front_##isa,                                                          \
   &simd::kkt_##isa},
constexpr Row rows[] = {PLUMB_FOR_EACH_ISA(PLUMB_ROW)};
#undef PLUMB_ROW

#define PLUMB_VALUE(isa, supported) Isa::isa,
constexpr Isa isas[] = {PLUMB_FOR_EACH_ISA(PLUMB_VALUE)};
#undef PLUMB_VALUE

/// Null for a value that is no Isa.
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
  const Row* const row = find_row(isa);
  return row ? row->name : "unknown";
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
