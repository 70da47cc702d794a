// The vector body of relaxation, compiled for what every machine has, on blocks that are really made: the
// bits of the scalar body.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <limits>

#include "relax/block.hpp"
#include "relax/plan.hpp"
#include "scenes/generators/generators.hpp"
#include "simd/relax/relax_lanes.hpp"
#include "support/islands.hpp"

namespace plumb::simd {
namespace {

/// Prepares and sweeps a block twice; its displacements, and the violation that is left.
template <class T>
std::vector<T> relaxed(const Scene& scene, LayoutChoice layout, const Kernels<T>& kernels) {
  const test::IslandsOf of(scene);
  const detail::Constants constants = detail::make_constants(scene);
  const std::vector<std::uint8_t> common(scene.rods.size(), 0);
  std::vector<T> out;
  for (layouts::Packing& packing :
       detail::plan_blocks(of.sets, layout, common, layouts::lane_width<T>, sizeof(T))) {
    detail::Block<T> block(std::move(packing), false);
    block.set_weights(constants, Weights::mass, SweepOrder::gauss_seidel, 1);
    const layouts::Packing& packed = block.packing();
    T* const p = block.displacement(0);
    for (std::uint32_t slot = 0; slot < packed.slot_vertex.size(); ++slot) {
      const std::uint32_t vertex = packed.slot_vertex[slot];
      block.write(block.x(), slot, scene.particles[vertex].position);
      block.write(p, slot, {0.01 * (vertex % 3), -0.02 * (vertex % 5), 0.001 * vertex});
    }
    const AccessKernels<T>& access = kernels.access[static_cast<std::size_t>(packed.access)];
    const BlockView<T> view = block.view(p);
    for (std::uint32_t q = 0; q < packed.positions; ++q)
      for (std::size_t stage = 0; stage < packed.stages.size(); ++stage)
        access.prepare(view, block.range(q, stage));
    for (int sweeps = 0; sweeps < 2; ++sweeps)
      for (std::size_t stage = 0; stage < packed.stages.size(); ++stage)
        for (std::uint32_t q = 0; q < packed.positions; ++q) {
          const Range range = block.range(q, stage);
          access.sweep[static_cast<std::size_t>(Gradient::new_)](view, &range, 1);
        }
    T worst = 0;
    for (std::uint32_t q = 0; q < packed.positions; ++q)
      for (std::size_t stage = 0; stage < packed.stages.size(); ++stage)
        worst = std::max(worst, access.violation(view, block.range(q, stage)));
    out.insert(out.end(), p, p + packed.elements);
    out.push_back(worst);
  }
  return out;
}

template <class T>
void expect_scalar_bits() {
  for (const Scene& scene :
       {scenes::make_chain(40), scenes::make_net(9, 7), scenes::make_graph({.particles = 60, .degree = 4})})
    for (const LayoutChoice layout : {LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa}) {
      const std::vector<T> wanted = relaxed<T>(scene, layout, kernels<T>(Isa::scalar));
      EXPECT_EQ(relaxed<T>(scene, layout, table<T>), wanted);
      EXPECT_GT(wanted.back(), 0) << "something is left to compare";
    }
}

TEST(RelaxBody, HasTheBitsOfTheScalarBody) {
  expect_scalar_bits<float>();
  expect_scalar_bits<double>();
}

TEST(RelaxBody, SeesWhatIsNotFinite) {
  alignas(64) double x[32] = {}, p[32] = {};
  EXPECT_TRUE(all_finite(x, p, 32));
  for (int i = 0; i < 32; ++i) {
    p[i] = i % 2 == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(all_finite(x, p, 32)) << i;
    p[i] = 0;
  }
}

TEST(RelaxBody, PredictsAndAdvances) {
  alignas(64) double x[16], p[16], u[16], kick[16];
  for (int i = 0; i < 16; ++i) x[i] = i, u[i] = 2 * i, kick[i] = 1;
  predict(p, u, kick, 0.5, 16);
  advance(x, p, 16);
  for (int i = 0; i < 16; ++i) EXPECT_EQ(x[i], 2 * i + 1);
  predict(p, u, kick, 1.0, 16);
  for (int i = 0; i < 16; ++i) EXPECT_EQ(p[i], 2 * i + 1);
  EXPECT_EQ(largest_lane(Batch<double>(3.0)), 3);
}

}  // namespace
}  // namespace plumb::simd
