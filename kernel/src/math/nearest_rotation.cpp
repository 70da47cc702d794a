#include "math/nearest_rotation.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;

/// Rotates rows and columns p and q of a symmetric matrix so that what couples them is 0, and the columns of
/// `vectors` with them.
void rotate(Matrix4& of, Matrix4& vectors, std::size_t p, std::size_t q) {
  if (of[p][q] == 0) return;
  const double slope = (of[q][q] - of[p][p]) / (2 * of[p][q]);
  const double t = (slope < 0 ? -1 : 1) / (std::abs(slope) + std::sqrt(1 + slope * slope));
  const double c = 1 / std::sqrt(1 + t * t), s = t * c;
  const auto turn = [&](double& first, double& second) {
    const double a = first, b = second;
    first = c * a - s * b;
    second = s * a + c * b;
  };
  for (std::size_t i = 0; i < 4; ++i) turn(of[i][p], of[i][q]);
  for (std::size_t i = 0; i < 4; ++i) turn(of[p][i], of[q][i]);
  for (std::size_t i = 0; i < 4; ++i) turn(vectors[i][p], vectors[i][q]);
  of[p][q] = of[q][p] = 0;
}

}  // namespace

std::array<double, 4> nearest_rotation(const std::array<Vec3, 3>& columns) {
  constexpr int sweeps = 8;  // Jacobi's method doubles the digits in each of the last ones
  const auto& [x, y, z] = columns;
  const double size = std::sqrt(dot(x, x) + dot(y, y) + dot(z, z));
  const double over = size > 0 ? 1 / size : 0;
  Matrix4 davenport{{{x.x + y.y + z.z, y.z - z.y, z.x - x.z, x.y - y.x},
                     {y.z - z.y, x.x - y.y - z.z, x.y + y.x, x.z + z.x},
                     {z.x - x.z, x.y + y.x, y.y - x.x - z.z, y.z + z.y},
                     {x.y - y.x, x.z + z.x, y.z + z.y, z.z - x.x - y.y}}};
  for (auto& numbers : davenport)
    for (double& each : numbers) each *= over;
  Matrix4 vectors{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t q = 1; q < 4; ++q)
      for (std::size_t p = 0; p < q; ++p) rotate(davenport, vectors, p, q);
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (davenport[i][i] > davenport[largest][largest]) largest = i;
  std::array<double, 4> out;
  double square = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    out[i] = vectors[i][largest];
    square += out[i] * out[i];
  }
  const double to_unit = (out[0] < 0 ? -1 : 1) / std::sqrt(square);
  for (double& each : out) each *= to_unit;
  return out;
}

}  // namespace plumb::detail
