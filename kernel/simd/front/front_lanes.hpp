// These loops eliminate and solve fronts (Duff, Reid 1983). V is double or a vector of doubles, and the file
// before this one defines load<V>(), store() and broadcast<V>(). Every number sees the same operations in the
// same order whatever V is. Each instruction set includes this file once.
#include <cmath>
#include <cstddef>

#include "simd/front/front_kernels.hpp"

namespace plumb::simd {
namespace {

/// A panel has so many pivots. They are eliminated from each other one by one, and from the rest of the front
/// all at once, which reads the rest once a panel.
constexpr std::uint32_t panel = 32;
/// So many rows share what is read of the pivots.
constexpr std::uint32_t shared_rows = 4;

template <class V>
constexpr std::uint32_t width = sizeof(V) / sizeof(double);

/// Returns the first column of the logical vector that a column lies in.
constexpr std::uint32_t whole_vector(std::uint32_t column) {
  return column / logical_width<double> * logical_width<double>;
}

/// Subtracts factor * from in columns [begin, end), where whole logical vectors begin and end.
template <class V>
inline __attribute__((always_inline)) void subtract_row(double* to, double factor, const double* from,
                                                        std::uint32_t begin, std::uint32_t end) {
  const V f = broadcast<V>(factor);
  for (std::uint32_t c = begin; c < end; c += width<V>)
    store(load<V>(to + c) - f * load<V>(from + c), to + c);
}

/// Makes columns [begin, end) of L, `vectors` vectors from row `at` on. Each is what earlier ones of the
/// panel leave of it, times the inverse of its pivot.
template <class V, std::uint32_t vectors>
inline __attribute__((always_inline)) void divide_columns(const FrontView& front, const double* block,
                                                          std::uint32_t begin, std::uint32_t end,
                                                          std::uint32_t at) {
  const std::size_t stride = front.stride;
  for (std::uint32_t k = begin; k < end; ++k) {
    V left[vectors];
    for (std::uint32_t v = 0; v < vectors; ++v)
      left[v] = load<V>(front.lower + k * stride + at + v * width<V>);
    for (std::uint32_t j = begin; j < k; ++j) {
      const V factor = broadcast<V>(block[j * stride + k]);
      for (std::uint32_t v = 0; v < vectors; ++v)
        left[v] = left[v] - factor * load<V>(front.lower + j * stride + at + v * width<V>);
    }
    const V inverse = broadcast<V>(front.inverse[k]);
    for (std::uint32_t v = 0; v < vectors; ++v)
      store(left[v] * inverse, front.lower + k * stride + at + v * width<V>);
  }
}

/// Subtracts what pivots [begin, end) take from `rows` rows, in `vectors` vectors from column `at` on.
template <class V, std::uint32_t rows, std::uint32_t vectors>
inline __attribute__((always_inline)) void subtract_product(const FrontView& front, double* block,
                                                            std::uint32_t begin, std::uint32_t end,
                                                            std::uint32_t row, std::uint32_t at) {
  const std::size_t stride = front.stride;
  V left[rows][vectors];
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t v = 0; v < vectors; ++v)
      left[i][v] = load<V>(block + (row + i) * stride + at + v * width<V>);
  for (std::uint32_t k = begin; k < end; ++k) {
    const double* lower = front.lower + k * stride + row;
    V upper[vectors];
    for (std::uint32_t v = 0; v < vectors; ++v) upper[v] = load<V>(block + k * stride + at + v * width<V>);
    for (std::uint32_t i = 0; i < rows; ++i) {
      const V factor = broadcast<V>(lower[i]);
      for (std::uint32_t v = 0; v < vectors; ++v) left[i][v] = left[i][v] - factor * upper[v];
    }
  }
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t v = 0; v < vectors; ++v)
      store(left[i][v], block + (row + i) * stride + at + v * width<V>);
}

/// Eliminates the pivots of a front, as FrontKernels says. L stands in front.lower alone, so that whole
/// vectors may run over its place in the block.
template <class V>
std::uint32_t eliminate(const FrontView& front, double* block, const double* smallest) {
  const std::size_t stride = front.stride;
  std::uint32_t left_out = 0;
  for (std::uint32_t begin = 0; begin < front.pivots; begin += panel) {
    const std::uint32_t end = begin + panel < front.pivots ? begin + panel : front.pivots;
    double own[panel][panel];  // holds L in the panel's own rows
    for (std::uint32_t k = begin; k < end; ++k) {
      const double pivot = block[k * stride + k];
      const bool keeps = std::abs(pivot) > smallest[k];
      front.inverse[k] = keeps ? 1 / pivot : 0;
      left_out += !keeps;
      for (std::uint32_t i = k + 1; i < end; ++i) {
        const double factor = block[i * stride + k] * front.inverse[k];
        own[k - begin][i - begin] = factor;
        if (factor != 0)
          subtract_row<V>(block + i * stride, factor, block + k * stride, whole_vector(k + 1), front.stride);
      }
    }
    const std::uint32_t rest = whole_vector(end);
    for (std::uint32_t k = begin; k < end; ++k) {
      double* lower = front.lower + k * stride;
      for (std::uint32_t i = whole_vector(k + 1); i < end; ++i) lower[i] = 0;
      for (std::uint32_t i = end; i < front.rows; ++i) lower[i] = block[i * stride + k];
      for (std::uint32_t i = front.rows; i < front.stride; ++i) lower[i] = 0;
    }
    std::uint32_t at = rest;
    for (; at + 2 * width<V> <= front.stride; at += 2 * width<V>)
      divide_columns<V, 2>(front, block, begin, end, at);
    for (; at < front.stride; at += width<V>) divide_columns<V, 1>(front, block, begin, end, at);
    for (std::uint32_t k = begin; k < end; ++k) {
      double* lower = front.lower + k * stride;
      for (std::uint32_t i = whole_vector(k + 1); i <= k; ++i) lower[i] = 0;
      for (std::uint32_t i = k + 1; i < end; ++i) lower[i] = own[k - begin][i - begin];
    }
    std::uint32_t row = end;
    for (; row + shared_rows <= front.rows; row += shared_rows) {
      for (at = rest; at + 2 * width<V> <= front.stride; at += 2 * width<V>)
        subtract_product<V, shared_rows, 2>(front, block, begin, end, row, at);
      for (; at < front.stride; at += width<V>)
        subtract_product<V, shared_rows, 1>(front, block, begin, end, row, at);
    }
    for (; row < front.rows; ++row)
      for (at = rest; at < front.stride; at += width<V>)
        subtract_product<V, 1, 1>(front, block, begin, end, row, at);
  }
  for (std::uint32_t k = 0; k < front.pivots; ++k) {
    double* upper = front.upper + k * stride;
    for (std::uint32_t c = whole_vector(k); c < front.stride; c += width<V>)
      store(load<V>(block + k * stride + c), upper + c);
    for (std::uint32_t c = whole_vector(k); c < k; ++c) upper[c] = 0;
  }
  return left_out;
}

/// Solves with L, one column of it after the other.
template <class V>
void forward(const FrontView& front, double* x) {
  for (std::uint32_t k = 0; k < front.pivots; ++k)
    subtract_row<V>(x, x[k], front.lower + std::size_t{k} * front.stride, whole_vector(k + 1), front.stride);
}

/// Solves with U. A row's sum has as many parts as a logical vector has lanes, so its bits do not depend on
/// V.
template <class V>
void backward(const FrontView& front, double* x) {
  constexpr std::uint32_t lanes = logical_width<double>;
  for (std::uint32_t k = front.pivots; k-- > 0;) {
    const double own = x[k];
    x[k] = 0;  // U's row begins with its pivot, which must add nothing
    const double* upper = front.upper + std::size_t{k} * front.stride;
    V part[lanes / width<V>];
    for (V& sum : part) sum = broadcast<V>(0);
    for (std::uint32_t c = whole_vector(k); c < front.stride; c += lanes)
      for (std::uint32_t v = 0; v < lanes / width<V>; ++v)
        part[v] = part[v] + load<V>(upper + c + v * width<V>) * load<V>(x + c + v * width<V>);
    alignas(layouts::alignment) double sums[lanes];
    for (std::uint32_t v = 0; v < lanes / width<V>; ++v) store(part[v], sums + v * width<V>);
    const double sum =
        ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
    x[k] = (own - sum) * front.inverse[k];
  }
}

}  // namespace
}  // namespace plumb::simd
