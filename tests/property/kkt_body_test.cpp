// The body of the loops on tiles of four, for vectors of two numbers, which every machine has: each of its
// steps against Eigen.

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
// The body is made of what stands before it.
// clang-format off
#include "simd/double_vector.hpp"
#include "simd/kkt/kkt_lanes.hpp"
// clang-format on

#include <Eigen/Core>

#include "simd/kkt/kkt_kernels.hpp"
#include "support/graphs.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using Matrix = Eigen::Map<Eigen::Matrix4d>;  // by columns, as tiles are

TEST(DoubleVector, SumsAcrossEachOfItsArguments) {
  alignas(64) const double a[2] = {1, 2}, b[2] = {10, 20};
  alignas(64) double sums[2];
  store(horizontal_sums(load<Batch>(a), load<Batch>(b)), sums);
  EXPECT_EQ(sums[0], 3);
  EXPECT_EQ(sums[1], 30);
  store(broadcast<Batch>(4) * load<Batch>(b), sums);
  EXPECT_EQ(sums[1], 80);
}

Block random_block(test::Random& random) {
  Block block;
  for (double& number : block.of) number = test::signed_unit(random);
  return block;
}

// To the rounding of four products of numbers below 1.
TEST(KktBody, MultipliesTilesAndTheirTransposes) {
  test::Random random(61);
  for (int round = 0; round < 20; ++round) {
    Block block = random_block(random), spread = random_block(random);
    Quad x, out;
    for (int i = 0; i < 4; ++i) x.of[i] = spread.of[4 * i];
    const Eigen::Vector4d v(x.of);
    Matrix4<Batch>(block).times(spread.of, 4).write(out.of);
    EXPECT_LE((Eigen::Vector4d(out.of) - Matrix(block.of) * v).norm(), 1e-15);
    Matrix4<Batch>(block).transposed_times(Vector4<Batch>::read(x.of)).write(out.of);
    EXPECT_LE((Eigen::Vector4d(out.of) - Matrix(block.of).transpose() * v).norm(), 1e-15);
  }
}

// K⁻¹ = L⁻ᵀ D⁻¹ L⁻¹: what factor_block() leaves is put together and multiplied with K.
TEST(KktBody, FactorsHoldTheInverse) {
  test::Random random(62);
  for (int round = 0; round < 20; ++round) {
    Block block = random_block(random);
    Eigen::Matrix4d k = Matrix(block.of) + Matrix(block.of).transpose();
    k.diagonal().array() += 6;
    Matrix(block.of) = k;
    factor_block(block.of);
    Eigen::Matrix4d inverse_l = Eigen::Matrix4d::Identity();
    inverse_l.leftCols<3>() += Matrix(block.of).leftCols<3>();
    const Eigen::Matrix4d inverse = inverse_l.transpose() * Matrix(block.of).col(3).asDiagonal() * inverse_l;
    EXPECT_LE((inverse * k - Eigen::Matrix4d::Identity()).norm(), 1e-14);
  }
}

// The table of this body does what the scalar one does, bit for bit.
TEST(KktBody, AddsAsTheScalarBodyDoes) {
  test::Random random(63);
  Lanes x[3], one[3], other[3];
  for (auto* lanes : {x, one})
    for (int i = 0; i < 3; ++i)
      for (double& number : lanes[i].of) number = test::signed_unit(random);
  std::copy(one, one + 3, other);
  kkt_table<Batch>.accumulate(one->of, x[1].of, x->of, 3);
  kkt_kernels(Isa::scalar).accumulate(other->of, x[1].of, x->of, 3);
  const KktTerm a{0.5, x[0].of}, b{-2, x[1].of}, c{3, x[2].of};
  kkt_table<Batch>.add_three(one->of, a, b, c, kkt_lanes);
  kkt_kernels(Isa::scalar).add_three(other->of, a, b, c, kkt_lanes);
  for (int i = 0; i < 3; ++i)
    for (std::size_t lane = 0; lane < kkt_lanes; ++lane) EXPECT_EQ(one[i].of[lane], other[i].of[lane]);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
