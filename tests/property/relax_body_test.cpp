// The vector bodies of relaxation, of every instruction set that this machine has, on blocks that are really
// made: the bits of the scalar body.

#pragma GCC diagnostic ignored "-Wpsabi"            // vectors that no call passes
#pragma GCC diagnostic ignored "-Wunused-function"  // bodies of crowds

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include <limits>

#include "relax/block.hpp"
#include "relax/plan.hpp"
#include "scenes/generators/generators.hpp"
#include "simd/relax/law_lanes.hpp"
#include "simd/relax/relax_lanes.hpp"
#include "simd/relax/visit_lanes.hpp"
#include "support/islands.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
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
    block.set_weights({constants, Weights::mass, SweepOrder::gauss_seidel, 1});
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
      for (const Isa isa : all_isas()) {
        if (!is_supported(isa)) continue;
        EXPECT_EQ(relaxed<T>(scene, layout, kernels<T>(isa)), wanted) << to_string(isa);
      }
      EXPECT_GT(wanted.back(), 0) << "something is left to compare";
    }
}

TEST(RelaxBody, HasTheBitsOfTheScalarBody) {
  expect_scalar_bits<float>();
  expect_scalar_bits<double>();
}

/// Gives rods several laws, and their ends off their lengths.
Scene with_laws(Scene scene) {
  const RodLaw laws[] = {{},
                         {.stiffness = 300},
                         {.stiffness = 40, .damping = 3, .one_sided = true},
                         {.one_sided = true},
                         {.stiffness = 1e5, .damping = 2}};
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    scene.rods[i].length = rod_length(scene, i) * (0.9 + 0.05 * static_cast<double>(i % 5));
    scene.rods[i].law = laws[i * i % 7 % 5];
  }
  return scene;
}

/// Prepares, sweeps twice and finishes a block of rods that give, after a substep that left them something.
template <class T>
std::vector<T> relaxed_laws(const Scene& scene, LayoutChoice layout, Gradient gradient, SweepOrder order,
                            const Kernels<T>& kernels) {
  const test::IslandsOf of(scene);
  const detail::Constants constants = detail::make_constants(scene);
  const std::vector<std::uint8_t> common(scene.rods.size(), 0);
  const auto g = static_cast<std::size_t>(gradient);
  const T h(0.01), half(gradient == Gradient::new_ ? 1 : 0.5);
  const LawTerms<T> terms{half * h, half, half * h * h, h, 1 / h, gradient == Gradient::old ? h : 0};
  std::vector<T> out;
  for (layouts::Packing& packing :
       detail::plan_blocks(of.sets, layout, common, layouts::lane_width<T>, sizeof(T))) {
    detail::Block<T> block(std::move(packing), order == SweepOrder::jacobi);
    block.set_weights({constants, Weights::mass, order, 1.25});
    const layouts::Packing& packed = block.packing();
    T* const p = block.displacement(0);
    for (std::uint32_t slot = 0; slot < packed.slot_vertex.size(); ++slot) {
      const std::uint32_t vertex = packed.slot_vertex[slot];
      block.write(block.x(), slot, scene.particles[vertex].position);
      block.write(p, slot, {0.01 * (vertex % 3), -0.02 * (vertex % 5), 0.001 * vertex});
    }
    for (std::size_t i = 0; i < block.half_kick().size(); ++i) block.half_kick()[i] = T(0.01) * T(i % 7);
    const LawKernels<T>& laws = kernels.access[static_cast<std::size_t>(packed.access)].laws;
    const LawView<T> view = block.law_view(p, terms);
    const auto for_ranges = [&](auto&& f) {
      for (std::size_t stage = 0; stage < packed.stages.size(); ++stage)
        for (std::uint32_t q = 0; q < packed.positions; ++q) f(block.range(q, stage));
    };
    T worst = 0;
    for_ranges([&](Range range) { laws.prepare(view, range); });
    for (int sweeps = 0; sweeps < 2; ++sweeps)
      for_ranges([&](Range range) { laws.sweep[g](view, &range, 1); });
    for_ranges([&](Range range) { worst = std::max(worst, laws.violation[g](view, range)); });
    for_ranges([&](Range range) { laws.finish(view, range); });
    out.insert(out.end(), view.out, view.out + packed.elements);
    out.insert(out.end(), view.half_kick, view.half_kick + block.half_kick().size());
    out.push_back(worst);
  }
  return out;
}

template <class T>
void expect_scalar_laws() {
  for (const Scene& plain :
       {scenes::make_chain(40), scenes::make_net(9, 7), scenes::make_graph({.particles = 60, .degree = 4})})
    for (const LayoutChoice layout : {LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa})
      for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
        for (const SweepOrder order : {SweepOrder::gauss_seidel, SweepOrder::jacobi}) {
          const Scene scene = with_laws(plain);
          const auto run = [&](const Kernels<T>& body) {
            return relaxed_laws<T>(scene, layout, gradient, order, body);
          };
          const std::vector<T> wanted = run(kernels<T>(Isa::scalar));
          for (const Isa isa : all_isas()) {
            if (!is_supported(isa)) continue;
            EXPECT_EQ(run(kernels<T>(isa)), wanted) << to_string(isa);
          }
          EXPECT_GT(wanted.back(), 0) << "something is left to compare";
          EXPECT_LT(wanted.back(), 10) << "it is a number";
        }
}

TEST(RelaxBody, HasTheBitsOfTheScalarBodyWhereRodsGive) {
  expect_scalar_laws<float>();
  expect_scalar_laws<double>();
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
}  // namespace plumb::simd::PLUMB_TEST_FILE
