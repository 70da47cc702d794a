// Loops on lanes. V is double or a vector of doubles; load<V>(), store() and broadcast<V>() are in scope.
// Every lane sees the same operations in the same order whatever V is. Included once per instruction set.
#include <cstddef>

#include "kkt_kernels.hpp"

namespace plumb::simd {
namespace {

template <class V>
constexpr std::size_t width = sizeof(V) / sizeof(double);

template <class V, std::size_t together>
void solve_together(const KktView& view, double* x) {
  constexpr std::size_t each = kkt_lanes / width<V>, vectors = together * each;
  const std::size_t apart = kkt_lanes * view.unknowns;
  const auto at = [&](std::uint32_t k, std::size_t v) {
    return x + v / each * apart + kkt_lanes * k + v % each * width<V>;
  };
  for (std::uint32_t k = 0; k < view.unknowns; ++k) {
    V own[vectors];
    for (std::size_t v = 0; v < vectors; ++v) own[v] = load<V>(at(k, v));
    for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i) {
      const std::uint32_t row = view.rows[i];
      const V factor = broadcast<V>(view.entries[i]);
      for (std::size_t v = 0; v < vectors; ++v) store(load<V>(at(row, v)) - factor * own[v], at(row, v));
    }
  }
  for (std::uint32_t k = view.unknowns; k-- > 0;) {
    const V inverse = broadcast<V>(view.diagonal[k]);
    V own[vectors];
    for (std::size_t v = 0; v < vectors; ++v) own[v] = load<V>(at(k, v)) * inverse;
    for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i) {
      const std::uint32_t row = view.rows[i];
      const V factor = broadcast<V>(view.entries[i]);
      for (std::size_t v = 0; v < vectors; ++v) own[v] = own[v] - factor * load<V>(at(row, v));
    }
    for (std::size_t v = 0; v < vectors; ++v) store(own[v], at(k, v));
  }
}

// Two batches at a time: one alone waits for its own results.
template <class V>
void solve(const KktView& view, std::size_t batches, double* x) {
  for (; batches >= 2; batches -= 2, x += 2 * kkt_lanes * view.unknowns) solve_together<V, 2>(view, x);
  if (batches > 0) solve_together<V, 1>(view, x);
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
