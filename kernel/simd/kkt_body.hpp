// Loops on lanes. V is double or a vector of doubles; load<V>(), store() and broadcast<V>() are in scope.
// Every lane sees the same operations in the same order whatever V is. Included once per instruction set.
#include <cstddef>

#include "kkt_kernels.hpp"

namespace plumb::simd {
namespace {

template <class V>
constexpr std::size_t width = sizeof(V) / sizeof(double);

// --- Blocks

/// Four numbers, in one or more vectors.
template <class V>
struct Column {
  static constexpr std::size_t vectors = 4 / width<V>;
  V of[vectors];

  static Column at(const double* from) {
    Column out;
    for (std::size_t v = 0; v < vectors; ++v) out.of[v] = load<V>(from + v * width<V>);
    return out;
  }
  void put(double* to) const {
    for (std::size_t v = 0; v < vectors; ++v) store(of[v], to + v * width<V>);
  }
  Column minus(const Column& other) const {
    Column out;
    for (std::size_t v = 0; v < vectors; ++v) out.of[v] = of[v] - other.of[v];
    return out;
  }
};

/// Four by four, in registers.
template <class V>
struct Matrix {
  Column<V> columns[4];

  explicit Matrix(const Block& block)
      : columns{Column<V>::at(block.of), Column<V>::at(block.of + 4), Column<V>::at(block.of + 8),
                Column<V>::at(block.of + 12)} {}
  /// Times four numbers that lie `apart`; in pairs, so that no sum waits for three others.
  Column<V> times(const double* x, std::size_t apart = 1) const {
    const V x0 = broadcast<V>(x[0]), x1 = broadcast<V>(x[apart]), x2 = broadcast<V>(x[2 * apart]),
            x3 = broadcast<V>(x[3 * apart]);
    Column<V> out;
    for (std::size_t v = 0; v < Column<V>::vectors; ++v)
      out.of[v] =
          (columns[0].of[v] * x0 + columns[1].of[v] * x1) + (columns[2].of[v] * x2 + columns[3].of[v] * x3);
    return out;
  }
  /// Its transpose times a column.
  Column<V> transposed_times(const Column<V>& x) const {
    Column<V> out;
    for (std::size_t v = 0; v < Column<V>::vectors; ++v) {
      const Column<V>* const own = columns + v * width<V>;
      if constexpr (width<V> == 1)
        out.of[v] =
            (own->of[0] * x.of[0] + own->of[1] * x.of[1]) + (own->of[2] * x.of[2] + own->of[3] * x.of[3]);
      else if constexpr (width<V> == 2)
        out.of[v] = add_across(own[0].of[0] * x.of[0], own[1].of[0] * x.of[0]) +
                    add_across(own[0].of[1] * x.of[1], own[1].of[1] * x.of[1]);
      else
        out.of[v] = add_across(own[0].of[0] * x.of[0], own[1].of[0] * x.of[0], own[2].of[0] * x.of[0],
                               own[3].of[0] * x.of[0]);
    }
    return out;
  }
};

/// Of a symmetric matrix, from its lower half: L D Lᵀ first, then L⁻¹.
inline void invert(const double* a, double* out) {
  const double d0 = 1 / a[0], l10 = a[1] * d0, l20 = a[2] * d0, l30 = a[3] * d0;
  const double b11 = a[5] - l10 * a[1], b21 = a[6] - l20 * a[1], b31 = a[7] - l30 * a[1];
  const double d1 = 1 / b11, l21 = b21 * d1, l31 = b31 * d1;
  const double b22 = (a[10] - l20 * a[2]) - l21 * b21, b32 = (a[11] - l30 * a[2]) - l31 * b21;
  const double d2 = 1 / b22, l32 = b32 * d2;
  const double d3 = 1 / (((a[15] - l30 * a[3]) - l31 * b31) - l32 * b32);
  const double m20 = l21 * l10 - l20, m31 = l32 * l21 - l31, m30 = (l31 * l10 - l30) - l32 * m20;
  const double e10 = -d1 * l10, e20 = d2 * m20, e21 = -d2 * l21, e30 = d3 * m30, e31 = d3 * m31,
               e32 = -d3 * l32;
  out[0] = ((d0 - e10 * l10) + e20 * m20) + e30 * m30;
  out[5] = (d1 - e21 * l21) + e31 * m31;
  out[10] = d2 - e32 * l32;
  out[15] = d3;
  out[1] = out[4] = (e10 - e20 * l21) + e30 * m31;
  out[2] = out[8] = e20 - e30 * l32;
  out[3] = out[12] = e30;
  out[6] = out[9] = e21 - e31 * l32;
  out[7] = out[13] = e31;
  out[11] = out[14] = e32;
}

template <class V>
void factor(const KktView& view, const std::uint32_t* target, Block* blocks) {
  for (std::uint32_t k = 0; k < view.columns; ++k) {
    double* const inverse = blocks[k].of;
    invert(inverse, inverse);
    Block* const end = blocks + view.columns + view.start[k + 1];
    for (Block* each = blocks + view.columns + view.start[k]; each != end; ++each) {
      const Matrix<V> above(*each);
      Block lower;
      for (std::size_t j = 0; j < 4; ++j) above.times(inverse + 4 * j).put(lower.of + 4 * j);
      for (const Block* other = each; other != end; ++other, ++target) {
        const Matrix<V> matrix(*other);
        double* const to = blocks[*target].of;
        for (std::size_t j = 0; j < 4; ++j)
          Column<V>::at(to + 4 * j).minus(matrix.times(lower.of + j, 4)).put(to + 4 * j);
      }
      for (std::size_t j = 0; j < 4; ++j) Column<V>::at(lower.of + 4 * j).put(each->of + 4 * j);
    }
  }
}

template <class V>
void solve(const KktView& view, Quad* x) {
  const Block* const lower = view.blocks + view.columns;
  for (std::uint32_t k = 0; k < view.columns; ++k)
    for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i) {
      double* const row = x[view.rows[i]].of;
      Column<V>::at(row).minus(Matrix<V>(lower[i]).times(x[k].of)).put(row);
    }
  for (std::uint32_t k = view.columns; k-- > 0;) {
    Column<V> own = Matrix<V>(view.blocks[k]).times(x[k].of);
    for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i)
      own = own.minus(Matrix<V>(lower[i]).transposed_times(Column<V>::at(x[view.rows[i]].of)));
    own.put(x[k].of);
  }
}

// --- Lanes

/// A block's four unknowns of as many right hand sides as fit into a vector, or two that do not wait for each
/// other.
template <class V, std::size_t together>
struct Four {
  V of[together][4];

  explicit Four(const double* x) {
    for (std::size_t t = 0; t < together; ++t)
      for (std::size_t i = 0; i < 4; ++i) of[t][i] = load<V>(x + t * width<V> + i * kkt_lanes);
  }
  void put(double* x) const {
    for (std::size_t t = 0; t < together; ++t)
      for (std::size_t i = 0; i < 4; ++i) store(of[t][i], x + t * width<V> + i * kkt_lanes);
  }
  V times(std::size_t t, const double* row, std::size_t apart) const {
    return (broadcast<V>(row[0]) * of[t][0] + broadcast<V>(row[apart]) * of[t][1]) +
           (broadcast<V>(row[2 * apart]) * of[t][2] + broadcast<V>(row[3 * apart]) * of[t][3]);
  }
};

template <class V>
void solve_lanes(const KktView& view, std::size_t batches, double* x) {
  const Block* const lower = view.blocks + view.columns;
  constexpr std::size_t together = width<V> == 4 ? 2 : 1, steps = kkt_lanes / (together * width<V>);
  using Own = Four<V, together>;
  for (std::size_t v = 0; v < batches * steps; ++v) {
    double* const at = x + v / steps * kkt_lanes * 4 * view.columns + v % steps * together * width<V>;
    const auto four = [&](std::uint32_t k) { return at + 4 * kkt_lanes * k; };
    for (std::uint32_t k = 0; k < view.columns; ++k) {
      const Own own(four(k));
      for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i) {
        double* const row = four(view.rows[i]);
        for (std::size_t n = 0; n < 4; ++n)
          for (std::size_t t = 0; t < together; ++t) {
            double* const to = row + n * kkt_lanes + t * width<V>;
            store(load<V>(to) - own.times(t, lower[i].of + n, 4), to);
          }
      }
    }
    for (std::uint32_t k = view.columns; k-- > 0;) {
      const Own before(four(k));
      Own own = before;
      for (std::size_t n = 0; n < 4; ++n)
        for (std::size_t t = 0; t < together; ++t) own.of[t][n] = before.times(t, view.blocks[k].of + n, 4);
      for (std::uint32_t i = view.start[k]; i < view.start[k + 1]; ++i) {
        const Own from(four(view.rows[i]));
        for (std::size_t n = 0; n < 4; ++n)
          for (std::size_t t = 0; t < together; ++t)
            own.of[t][n] = own.of[t][n] - from.times(t, lower[i].of + 4 * n, 1);
      }
      own.put(four(k));
    }
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

template <class V>
constexpr KktKernels kkt_table{factor<V>, solve<V>, solve_lanes<V>, combine<V>, add_three<V>, accumulate<V>};

}  // namespace
}  // namespace plumb::simd
