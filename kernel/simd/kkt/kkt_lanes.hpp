// These loops work on tiles of four and on lanes of right-hand sides. V is double or a vector of doubles, and
// the file before this one defines load<V>(), store() and broadcast<V>(). Every lane sees the same operations
// in the same order whatever V is. Each instruction set includes this file once.
#include <cstddef>

#include "simd/kkt/kkt_kernels.hpp"

namespace plumb::simd {
namespace {

template <class V>
constexpr std::size_t width = sizeof(V) / sizeof(double);

// --- Blocks

/// One or more vectors hold four numbers.
template <class V>
struct Vector4 {
  static constexpr std::size_t vectors = 4 / width<V>;
  V of[vectors];

  static Vector4 read(const double* from) {
    Vector4 out;
    for (std::size_t v = 0; v < vectors; ++v) out.of[v] = load<V>(from + v * width<V>);
    return out;
  }
  void write(double* to) const {
    for (std::size_t v = 0; v < vectors; ++v) store(of[v], to + v * width<V>);
  }
  Vector4 operator-(const Vector4& other) const {
    Vector4 out;
    for (std::size_t v = 0; v < vectors; ++v) out.of[v] = of[v] - other.of[v];
    return out;
  }
  Vector4 operator+(const Vector4& other) const {
    Vector4 out;
    for (std::size_t v = 0; v < vectors; ++v) out.of[v] = of[v] + other.of[v];
    return out;
  }
  Vector4 operator*(const Vector4& other) const {
    Vector4 out;
    for (std::size_t v = 0; v < vectors; ++v) out.of[v] = of[v] * other.of[v];
    return out;
  }
  Vector4 operator*(double factor) const {
    const V by = broadcast<V>(factor);
    Vector4 out;
    for (std::size_t v = 0; v < vectors; ++v) out.of[v] = of[v] * by;
    return out;
  }
};

/// A tile of 4 x 4 numbers is in registers, one column after the other.
template <class V>
struct Matrix4 {
  Vector4<V> columns[4];

  explicit Matrix4(const Block& block)
      : columns{Vector4<V>::read(block.of), Vector4<V>::read(block.of + 4), Vector4<V>::read(block.of + 8),
                Vector4<V>::read(block.of + 12)} {}
  /// Multiplies it with four numbers that stand `stride` apart. It adds in pairs, so that no sum waits for
  /// three others.
  Vector4<V> times(const double* x, std::size_t stride = 1) const {
    const V x0 = broadcast<V>(x[0]), x1 = broadcast<V>(x[stride]), x2 = broadcast<V>(x[2 * stride]),
            x3 = broadcast<V>(x[3 * stride]);
    Vector4<V> out;
    for (std::size_t v = 0; v < Vector4<V>::vectors; ++v)
      out.of[v] =
          (columns[0].of[v] * x0 + columns[1].of[v] * x1) + (columns[2].of[v] * x2 + columns[3].of[v] * x3);
    return out;
  }
  /// Multiplies its transpose with a column.
  Vector4<V> transposed_times(const Vector4<V>& x) const {
    Vector4<V> out;
    for (std::size_t v = 0; v < Vector4<V>::vectors; ++v) {
      const Vector4<V>* const own = columns + v * width<V>;
      if constexpr (width<V> == 1)
        out.of[v] =
            (own->of[0] * x.of[0] + own->of[1] * x.of[1]) + (own->of[2] * x.of[2] + own->of[3] * x.of[3]);
      else if constexpr (width<V> == 2)
        out.of[v] = horizontal_sums(own[0].of[0] * x.of[0], own[1].of[0] * x.of[0]) +
                    horizontal_sums(own[0].of[1] * x.of[1], own[1].of[1] * x.of[1]);
      else
        out.of[v] = horizontal_sums(own[0].of[0] * x.of[0], own[1].of[0] * x.of[0], own[2].of[0] * x.of[0],
                                    own[3].of[0] * x.of[0]);
    }
    return out;
  }
};

/// Factorises a symmetric tile K = L D Lᵀ, of which it reads the lower half. The first three columns become
/// L⁻¹ below its diagonal, and the fourth becomes D⁻¹. K⁻¹ itself would lose digits where masses differ. The
/// code is scalar, since each division waits for the one before.
inline void factor_block(double* a) {
  const double d0 = 1 / a[0], l10 = a[1] * d0, l20 = a[2] * d0, l30 = a[3] * d0;
  const double b21 = a[6] - l20 * a[1], b31 = a[7] - l30 * a[1];
  const double d1 = 1 / (a[5] - l10 * a[1]), l21 = b21 * d1, l31 = b31 * d1;
  const double b32 = (a[11] - l30 * a[2]) - l31 * b21;
  const double d2 = 1 / ((a[10] - l20 * a[2]) - l21 * b21), l32 = b32 * d2;
  const double d3 = 1 / (((a[15] - l30 * a[3]) - l31 * b31) - l32 * b32);
  const double m20 = l21 * l10 - l20, m31 = l32 * l21 - l31;
  a[0] = 0, a[1] = -l10, a[2] = m20, a[3] = (l31 * l10 - l30) - l32 * m20;
  a[4] = 0, a[5] = 0, a[6] = -l21, a[7] = m31;
  a[8] = 0, a[9] = 0, a[10] = 0, a[11] = -l32;
  a[12] = d0, a[13] = d1, a[14] = d2, a[15] = d3;
}

/// Factorises a matrix of tiles from the left to the right, as KktKernels::factor() says.
template <class V>
void factor(const KktPattern& pattern, const std::uint32_t* target, Block* blocks) {
  for (std::uint32_t k = 0; k < pattern.columns; ++k) {
    double* const inverse = blocks[k].of;
    factor_block(inverse);
    Block* const first = blocks + pattern.columns + pattern.start[k];
    Block* const end = blocks + pattern.columns + pattern.start[k + 1];
    for (Block* each = first; each != end; ++each) {  // it becomes itself times L⁻ᵀ
      const Matrix4<V> entry(*each);
      (entry.columns[1] + entry.columns[0] * inverse[1]).write(each->of + 4);
      (entry.columns[2] + (entry.columns[0] * inverse[2] + entry.columns[1] * inverse[6]))
          .write(each->of + 8);
      ((entry.columns[3] + entry.columns[0] * inverse[3]) +
       (entry.columns[1] * inverse[7] + entry.columns[2] * inverse[11]))
          .write(each->of + 12);
    }
    for (Block* each = first; each != end; ++each) {
      const Matrix4<V> entry(*each);
      Block lower;
      for (std::size_t j = 0; j < 4; ++j) (entry.columns[j] * inverse[12 + j]).write(lower.of + 4 * j);
      for (const Block* other = each; other != end; ++other, ++target) {
        const Matrix4<V> matrix(*other);
        double* const to = blocks[*target].of;
        for (std::size_t j = 0; j < 4; ++j)
          (Vector4<V>::read(to + 4 * j) - matrix.times(lower.of + j, 4)).write(to + 4 * j);
      }
      for (std::size_t j = 0; j < 4; ++j) Vector4<V>::read(lower.of + 4 * j).write(each->of + 4 * j);
    }
  }
}

/// Solves with L and D, then with Lᵀ.
template <class V>
void solve(const KktPattern& pattern, const Block* factors, Quad* x) {
  const Block* const lower = factors + pattern.columns;
  for (std::uint32_t k = 0; k < pattern.columns; ++k) {
    const double *const own = x[k].of, *const inverse = factors[k].of;
    const auto column = [&](std::size_t j) { return Vector4<V>::read(inverse + 4 * j) * own[j]; };
    ((Vector4<V>::read(own) + column(0)) + (column(1) + column(2))).write(x[k].of);
    for (std::uint32_t i = pattern.start[k]; i < pattern.start[k + 1]; ++i) {
      double* const row = x[pattern.rows[i]].of;
      (Vector4<V>::read(row) - Matrix4<V>(lower[i]).times(own)).write(row);
    }
  }
  for (std::uint32_t k = pattern.columns; k-- > 0;) {
    Matrix4<V> inverse(factors[k]);
    Vector4<V> own = Vector4<V>::read(x[k].of) * inverse.columns[3];
    for (std::uint32_t i = pattern.start[k]; i < pattern.start[k + 1]; ++i)
      own = own - Matrix4<V>(lower[i]).transposed_times(Vector4<V>::read(x[pattern.rows[i]].of));
    inverse.columns[3] = inverse.columns[3] * 0.0;  // D⁻¹ is no column of L⁻¹
    (own + inverse.transposed_times(own)).write(x[k].of);
  }
}

// --- Lanes

/// The four unknowns of a tile are in registers for as many right-hand sides as a vector holds. Where there
/// are registers enough (AVX2), `together` is 2, and neither vector waits for the other.
template <class V, std::size_t together>
struct LaneVectors {
  V of[together][4];

  explicit LaneVectors(const double* x) {
    for (std::size_t t = 0; t < together; ++t)
      for (std::size_t i = 0; i < 4; ++i) of[t][i] = load<V>(x + t * width<V> + i * kkt_lanes);
  }
  void put(double* x) const {
    for (std::size_t t = 0; t < together; ++t)
      for (std::size_t i = 0; i < 4; ++i) store(of[t][i], x + t * width<V> + i * kkt_lanes);
  }
  V times(std::size_t t, const double* row, std::size_t stride) const {
    return (broadcast<V>(row[0]) * of[t][0] + broadcast<V>(row[stride]) * of[t][1]) +
           (broadcast<V>(row[2 * stride]) * of[t][2] + broadcast<V>(row[3 * stride]) * of[t][3]);
  }
};

/// Does for lanes of right-hand sides what solve() does for one.
template <class V>
void solve_lanes(const KktPattern& pattern, const Block* factors, std::size_t batches, double* x) {
  const Block* const lower = factors + pattern.columns;
  constexpr std::size_t together = width<V> == 4 ? 2 : 1, steps = kkt_lanes / (together * width<V>);
  using Own = LaneVectors<V, together>;
  for (std::size_t v = 0; v < batches * steps; ++v) {
    double* const at = x + v / steps * kkt_lanes * 4 * pattern.columns + v % steps * together * width<V>;
    const auto four = [&](std::uint32_t k) { return at + 4 * kkt_lanes * k; };
    for (std::uint32_t k = 0; k < pattern.columns; ++k) {
      Own own(four(k));
      const double* const inverse = factors[k].of;
      for (std::size_t t = 0; t < together; ++t) {
        const auto part = [&](std::size_t j, std::size_t i) {
          return broadcast<V>(inverse[4 * j + i]) * own.of[t][j];
        };
        own.of[t][3] = (own.of[t][3] + part(0, 3)) + (part(1, 3) + part(2, 3));
        own.of[t][2] = (own.of[t][2] + part(0, 2)) + part(1, 2);
        own.of[t][1] = own.of[t][1] + part(0, 1);
      }
      own.put(four(k));
      for (std::uint32_t i = pattern.start[k]; i < pattern.start[k + 1]; ++i) {
        double* const row = four(pattern.rows[i]);
        for (std::size_t n = 0; n < 4; ++n)
          for (std::size_t t = 0; t < together; ++t) {
            double* const to = row + n * kkt_lanes + t * width<V>;
            store(load<V>(to) - own.times(t, lower[i].of + n, 4), to);
          }
      }
    }
    for (std::uint32_t k = pattern.columns; k-- > 0;) {
      Own own(four(k));
      const double* const inverse = factors[k].of;
      for (std::size_t t = 0; t < together; ++t)
        for (std::size_t n = 0; n < 4; ++n) own.of[t][n] = own.of[t][n] * broadcast<V>(inverse[12 + n]);
      for (std::uint32_t i = pattern.start[k]; i < pattern.start[k + 1]; ++i) {
        const Own from(four(pattern.rows[i]));
        for (std::size_t n = 0; n < 4; ++n)
          for (std::size_t t = 0; t < together; ++t)
            own.of[t][n] = own.of[t][n] - from.times(t, lower[i].of + 4 * n, 1);
      }
      for (std::size_t t = 0; t < together; ++t) {
        const auto part = [&](std::size_t j, std::size_t i) {
          return broadcast<V>(inverse[4 * j + i]) * own.of[t][i];
        };
        own.of[t][0] = own.of[t][0] + (part(0, 1) + (part(0, 2) + part(0, 3)));
        own.of[t][1] = own.of[t][1] + (part(1, 2) + part(1, 3));
        own.of[t][2] = own.of[t][2] + part(2, 3);
      }
      own.put(four(k));
    }
  }
}

template <class V>
void combine(const double* x, std::uint32_t unknowns, std::size_t batches, const KktSum& of, double* out) {
  constexpr std::size_t vectors = kkt_lanes / width<V>;
  for (std::size_t batch = 0; batch < batches; ++batch) {
    V sum[vectors];
    for (std::size_t v = 0; v < vectors; ++v) sum[v] = broadcast<V>(0);
    for (std::uint32_t i = 0; i < of.count; ++i) {
      const V factor = broadcast<V>(of.factors[i]);
      for (std::size_t v = 0; v < vectors; ++v)
        sum[v] = sum[v] + factor * load<V>(x + kkt_lanes * of.slots[i] + v * width<V>);
    }
    for (std::size_t v = 0; v < vectors; ++v) store(sum[v], out + v * width<V>);
    x += kkt_lanes * unknowns;
    out += kkt_lanes;
  }
}

template <class V>
void add_three(double* to, KktTerm a, KktTerm b, KktTerm c, std::uint32_t count) {
  const V by_a = broadcast<V>(a.factor), by_b = broadcast<V>(b.factor), by_c = broadcast<V>(c.factor);
  for (std::uint32_t i = 0; i < count; i += width<V>)
    store(load<V>(to + i) + by_a * load<V>(a.x + i) + by_b * load<V>(b.x + i) + by_c * load<V>(c.x + i),
          to + i);
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
