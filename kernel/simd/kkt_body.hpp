// Loops on lanes. V is double or a vector of doubles; load<V>(), store() and broadcast<V>() are in scope.
// Every lane sees the same operations in the same order whatever V is. Included once per instruction set.
#include <cstddef>

#include "kkt_kernels.hpp"

namespace plumb::simd {
namespace {

template <class V>
constexpr std::size_t width = sizeof(V) / sizeof(double);

template <class V>
void solve(const KktView& view, double* x) {
  constexpr std::size_t vectors = kkt_lanes / width<V>;
  for (std::uint32_t k = 0; k < view.unknowns; ++k) {
    V own[vectors];
    for (std::size_t v = 0; v < vectors; ++v) own[v] = load<V>(x + kkt_lanes * k + v * width<V>);
    for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i) {
      double* const row = x + kkt_lanes * view.rows[i];
      const V factor = broadcast<V>(view.entries[i]);
      for (std::size_t v = 0; v < vectors; ++v)
        store(load<V>(row + v * width<V>) - factor * own[v], row + v * width<V>);
    }
  }
  for (std::uint32_t k = view.unknowns; k-- > 0;) {
    const V inverse = broadcast<V>(view.diagonal[k]);
    V own[vectors];
    for (std::size_t v = 0; v < vectors; ++v) own[v] = load<V>(x + kkt_lanes * k + v * width<V>) * inverse;
    for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i) {
      const double* const row = x + kkt_lanes * view.rows[i];
      const V factor = broadcast<V>(view.entries[i]);
      for (std::size_t v = 0; v < vectors; ++v) own[v] = own[v] - factor * load<V>(row + v * width<V>);
    }
    for (std::size_t v = 0; v < vectors; ++v) store(own[v], x + kkt_lanes * k + v * width<V>);
  }
}

template <class V>
void combine(const double* x, std::uint32_t unknowns, std::size_t batches, const std::uint32_t* slots,
             const double* factors, std::uint32_t count, double* out) {
  constexpr std::size_t vectors = kkt_lanes / width<V>;
  for (std::size_t batch = 0; batch < batches; ++batch) {
    V sum[vectors];
    for (std::size_t v = 0; v < vectors; ++v) sum[v] = broadcast<V>(0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const V factor = broadcast<V>(factors[i]);
      for (std::size_t v = 0; v < vectors; ++v)
        sum[v] = sum[v] + factor * load<V>(x + kkt_lanes * slots[i] + v * width<V>);
    }
    for (std::size_t v = 0; v < vectors; ++v) store(sum[v], out + v * width<V>);
    x += kkt_lanes * unknowns;
    out += kkt_lanes;
  }
}

template <class V>
void add_three(double* to, double a, const double* x, double b, const double* y, double c, const double* z,
               std::uint32_t count) {
  const V va = broadcast<V>(a), vb = broadcast<V>(b), vc = broadcast<V>(c);
  for (std::uint32_t i = 0; i < count; i += width<V>)
    store(load<V>(to + i) + va * load<V>(x + i) + vb * load<V>(y + i) + vc * load<V>(z + i), to + i);
}

template <class V>
void accumulate(double* to, const double* factors, const double* x, std::uint32_t unknowns) {
  constexpr std::size_t vectors = kkt_lanes / width<V>;
  V factor[vectors];
  for (std::size_t v = 0; v < vectors; ++v) factor[v] = load<V>(factors + v * width<V>);
  for (std::uint32_t k = 0; k < unknowns; ++k)
    for (std::size_t v = 0; v < vectors; ++v) {
      double* const at = to + kkt_lanes * k + v * width<V>;
      store(load<V>(at) + factor[v] * load<V>(x + kkt_lanes * k + v * width<V>), at);
    }
}

}  // namespace
}  // namespace plumb::simd
