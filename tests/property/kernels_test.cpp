// Every instruction set gives the scalar body's bits, on the addresses that packings really make and on
// numbers from zero to infinity. Two results are the same if their bits are, or if both are not a number:
// which of two NaNs survives an addition depends on the order of its operands, which a compiler may choose.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/packing.hpp"
#include "plumb/layouts/shapes.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "support/graphs.hpp"
#include "support/sanitizers.hpp"
#include "threads/flush_denormals.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using layouts::AlignedBuffer;
using layouts::none;
using layouts::Packing;
using test::below;
using test::Random;

std::vector<Isa> vector_isas() {
  std::vector<Isa> isas;
  for (const Isa isa : all_isas())
    if (isa != Isa::scalar && is_supported(isa)) isas.push_back(isa);
  return isas;
}

template <class T>
bool same(T a, T b) {
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b) || (std::isnan(a) && std::isnan(b));
}

template <class T>
AlignedBuffer<T> copy(const AlignedBuffer<T>& from) {
  AlignedBuffer<T> to(from.size());
  std::copy_n(from.data(), from.size(), to.data());
  return to;
}

/// Index of the first number that differs, or -1.
template <class T>
std::ptrdiff_t first_difference(const AlignedBuffer<T>& a, const AlignedBuffer<T>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same(a[i], b[i])) return static_cast<std::ptrdiff_t>(i);
  return -1;
}

/// Whether rods were moved by the same bits. Padding may differ, which moves nothing.
template <class T>
bool moved_alike(const Packing& packing, const AlignedBuffer<T>& a, const AlignedBuffer<T>& b) {
  const std::size_t width = packing.lanes;
  for (std::size_t lane = 0; lane < packing.lane_edge.size(); ++lane)
    for (std::size_t field = 0; packing.lane_edge[lane] != none && field < moved_fields; ++field) {
      const std::size_t i = (lane / width * moved_fields + field) * width + lane % width;
      if (!same(a[i], b[i])) return false;
    }
  return true;
}

/// Islands with a number that is infinite or not a number.
template <class T>
std::set<std::uint32_t> broken_islands(const Packing& packing, const AlignedBuffer<T>& field) {
  std::set<std::uint32_t> broken;
  for (std::size_t slot = 0; slot < packing.slot_offset.size(); ++slot)
    for (std::uint32_t c = 0; c < 3; ++c)
      if (!std::isfinite(field[packing.slot_offset[slot] + c * packing.component_stride]))
        broken.insert(packing.slot_island[slot]);
  return broken;
}

/// The same bits for every particle, or islands broken in both: those are put back as a whole, and how far
/// what is not a number has come along them, through padding too, is no result.
template <class T>
testing::AssertionResult agree(const Packing& packing, const AlignedBuffer<T>& a, const AlignedBuffer<T>& b) {
  const std::set<std::uint32_t> broken = broken_islands(packing, a);
  if (broken != broken_islands(packing, b)) return testing::AssertionFailure() << "other islands are broken";
  for (std::size_t slot = 0; slot < packing.slot_offset.size(); ++slot)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::size_t i = packing.slot_offset[slot] + c * packing.component_stride;
      if (broken.count(packing.slot_island[slot]) == 0 && !same(a[i], b[i]))
        return testing::AssertionFailure() << "number " << i << ": " << a[i] << " and " << b[i];
    }
  return testing::AssertionSuccess();
}

enum class Numbers { ordinary, extreme, broken };

/// ordinary: a scene in motion. extreme: from zero over denormal to the square root of the largest number and
/// beyond. broken: now and then infinite or not a number.
template <class T>
T number(Random& random, Numbers numbers, T scale) {
  const T unit = static_cast<T>(test::signed_unit(random));
  using Limits = std::numeric_limits<T>;
  if (numbers == Numbers::extreme) {
    switch (below(random, 8)) {
      case 0:
        return 0;
      case 1:
        return -T(0);
      case 2:
        return unit * Limits::min();  // most are denormal
      case 3:
        return unit * std::sqrt(Limits::max());
      case 4:
        return unit * Limits::max() / 4;
      case 5:
        return unit * Limits::epsilon();
      default:
        break;
    }
  } else if (numbers == Numbers::broken) {
    switch (below(random, 40)) {
      case 0:
        return Limits::infinity();
      case 1:
        return -Limits::infinity();
      case 2:
        return Limits::quiet_NaN();
      default:
        break;
    }
  }
  return unit * scale;
}

Packing chain_packing(std::uint32_t rods, std::uint32_t lanes, std::uint32_t bytes, bool streams) {
  const layouts::LocalGraph g = test::lattice(rods + 1, 1);
  const layouts::Islands islands = find_islands(g.view());
  const layouts::Piece piece{0, islands.vertices(0), islands.edges(0)};
  const layouts::ShapeInfo shape = detect_shape(g.view());
  return streams ? pack_streams(piece, shape, lanes, bytes) : pack_segments(piece, shape, lanes);
}

Packing grid_packing(std::uint32_t width, std::uint32_t height, std::uint32_t lanes) {
  const layouts::LocalGraph g = test::lattice(width, height);
  const layouts::Islands islands = find_islands(g.view());
  return pack_strips({0, islands.vertices(0), islands.edges(0)}, detect_shape(g.view()), lanes);
}

Packing graph_packing(Random& random, layouts::Layout layout, std::uint32_t lanes, std::uint32_t bytes) {
  layouts::LocalGraph g = test::random_graph(random, 200, 400);
  g.movable.assign(g.movable.size(), 1);
  const layouts::Islands islands = find_islands(g.view());
  std::vector<layouts::LocalGraph> locals;
  for (std::uint32_t i = 0; i < islands.count(); ++i) locals.push_back(local_graph(g.view(), islands, i));
  std::vector<layouts::IndexedPiece> pieces;
  for (std::uint32_t i = 0; i < islands.count(); ++i)
    pieces.push_back(
        {{i, islands.vertices(i), islands.edges(i)}, locals[i].view(), color_edges(locals[i].view()), {}});
  return pack_indexed(pieces, layout, std::vector<std::uint8_t>(g.edges.size(), 1), lanes, bytes, "graph");
}

/// Packings that use every way of addressing rods, odd sizes among them.
template <class T>
std::vector<Packing> packings(Random& random) {
  constexpr std::uint32_t lanes = logical_width<T>, bytes = sizeof(T);
  std::vector<Packing> list;
  list.push_back(chain_packing(1 + below(random, 700), lanes, bytes, true));
  list.push_back(chain_packing(1 + below(random, 200), lanes, bytes, false));
  list.push_back(grid_packing(2 + below(random, 9), 2 + below(random, 70), lanes));
  list.push_back(graph_packing(random, layouts::Layout::soa, lanes, bytes));
  list.push_back(graph_packing(random, layouts::Layout::aosoa, lanes, bytes));
  list.push_back(graph_packing(random, layouts::Layout::aos, lanes, bytes));
  return list;
}

/// A block with random numbers for one packing. Padding weighs nothing, as in the simulation.
template <class T>
struct Data {
  static constexpr std::uint32_t width = logical_width<T>;

  Data(const Packing& packing_, Random& random, Numbers numbers)
      : packing(packing_),
        x(packing.elements),
        p(packing.elements),
        accumulator(packing.elements),
        rod(std::size_t{packing.vectors()} * rod_fields * width),
        weight(std::size_t{packing.vectors()} * weight_fields * width) {
    for (const std::uint32_t offset : packing.slot_offset)
      for (std::uint32_t c = 0; c < 3; ++c) {
        x[offset + c * packing.component_stride] = number(random, numbers, T(3));
        p[offset + c * packing.component_stride] = number(random, numbers, T(0.1));
      }
    for (std::size_t i = 0; i < packing.lane_edge.size(); ++i) {
      T* fields = weight.data() + i / width * weight_fields * width + i % width;
      const T length2 = T(0.01) + std::abs(static_cast<T>(test::signed_unit(random)));
      const bool padding = packing.lane_edge[i] == none;
      fields[0] = padding ? 1 : length2;
      fields[width] = padding ? 0 : std::abs(static_cast<T>(test::signed_unit(random)));
      fields[2 * width] = padding ? 0 : std::abs(static_cast<T>(test::signed_unit(random)));
      fields[3 * width] = padding ? 0 : 1 / length2;
    }
    // Uniform ranges hold no padding; of those that could be uniform, half are.
    for (std::uint32_t q = 0; q < packing.positions; ++q)
      for (const layouts::Stage& stage : packing.stages) {
        const std::uint32_t begin = q * packing.position_vectors + stage.begin;
        const auto lane = packing.lane_edge.begin();
        const bool full = std::count(lane + begin * width, lane + (begin + stage.count) * width, none) == 0;
        ranges.push_back({begin, begin + stage.count, full && below(random, 2) == 0});
      }
  }

  /// With what kernels write to given by the caller.
  BlockView<T> view(T* p_, T* out, T* rod_) const {
    return {.x = x.data(),
            .p = p_,
            .out = out,
            .component_stride = packing.component_stride,
            .rod = rod_,
            .weight = weight.data(),
            .address_a = packing.address_a.data(),
            .address_b = packing.address_b.data(),
            .uniform_length2 = T(0.37),
            .uniform_share = T(0.125),
            .uniform_inverse_length2 = 1 / T(0.37)};
  }
  BlockView<T> view() { return view(p.data(), p.data(), rod.data()); }

  const Packing& packing;
  AlignedBuffer<T> x, p, accumulator, rod, weight;
  std::vector<Range> ranges;
};

template <class T>
struct Outcome {
  AlignedBuffer<T> p, accumulator, rod, moved;
  std::vector<T> violations;
};

/// Prepares, measures and sweeps twice, the second time counting; everything written.
template <class T>
Outcome<T> relax(const Kernels<T>& table, const Data<T>& data, Gradient gradient, bool jacobi) {
  Outcome<T> out{copy(data.p),
                 copy(data.accumulator),
                 copy(data.rod),
                 AlignedBuffer<T>(data.rod.size() / rod_fields * moved_fields),
                 {}};
  BlockView<T> view = data.view(out.p.data(), jacobi ? out.accumulator.data() : out.p.data(), out.rod.data());
  view.moved = out.moved.data();
  const AccessKernels<T>& kernels = table.access[static_cast<int>(data.packing.access)];
  for (const Range range : data.ranges) kernels.prepare(view, range);
  for (int sweep = 0; sweep < 2; ++sweep) {
    for (const Range range : data.ranges) out.violations.push_back(kernels.violation(view, range));
    const auto& sweeps = sweep == 0 ? kernels.sweep : kernels.count;
    sweeps[static_cast<int>(gradient)](view, data.ranges.data(),
                                       static_cast<std::uint32_t>(data.ranges.size()));
  }
  return out;
}

template <class T>
class KernelsOf : public testing::Test {
 protected:
  Random random{2024};
};
using Precisions = testing::Types<float, double>;
struct PrecisionName {
  template <class T>
  static std::string GetName(int) {
    return sizeof(T) == 4 ? "Float" : "Double";
  }
};
TYPED_TEST_SUITE(KernelsOf, Precisions, PrecisionName);

constexpr Gradient all_gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};

TYPED_TEST(KernelsOf, RelaxationHasTheScalarBits) {
  using T = TypeParam;
  int uniform = 0, general = 0, whole = 0;
  for (int round = 0; round < test::scaled(60); ++round)
    for (const Packing& packing : packings<T>(this->random))
      for (const Numbers numbers : {Numbers::ordinary, Numbers::extreme, Numbers::broken}) {
        const Data<T> data(packing, this->random, numbers);
        for (const Range range : data.ranges) ++(range.uniform ? uniform : general);
        for (const Gradient gradient : all_gradients)
          for (const bool jacobi : {false, true}) {
            const Outcome<T> wanted = relax(kernels<T>(Isa::scalar), data, gradient, jacobi);
            for (const Isa isa : vector_isas()) {
              const Outcome<T> got = relax(kernels<T>(isa), data, gradient, jacobi);
              const std::string what = std::string(to_string(isa)) + ", " + std::string(packing.shape) +
                                       ", access " + std::to_string(static_cast<int>(packing.access)) +
                                       ", gradient " + std::string(to_string(gradient)) +
                                       (jacobi ? ", jacobi" : "");
              ASSERT_EQ(first_difference(wanted.rod, got.rod), -1) << "prepare: " << what;
              ASSERT_TRUE(agree(packing, wanted.p, got.p)) << "sweep: " << what;
              ASSERT_TRUE(agree(packing, wanted.accumulator, got.accumulator)) << "sweep: " << what;
              const AlignedBuffer<T>& swept = jacobi ? wanted.accumulator : wanted.p;
              if (!broken_islands(packing, swept).empty()) continue;
              ++whole;
              ASSERT_TRUE(moved_alike(packing, wanted.moved, got.moved)) << "count: " << what;
              for (std::size_t i = 0; i < wanted.violations.size(); ++i)
                ASSERT_TRUE(same(wanted.violations[i], got.violations[i])) << "violation: " << what;
            }
          }
      }
  // None of these may be missing from what was compared.
  EXPECT_GT(uniform, test::scaled(100));
  EXPECT_GT(general, test::scaled(100));
  EXPECT_GT(whole, test::scaled(1000) * static_cast<int>(vector_isas().size()));
}

// What the simulation runs under must not make the bodies differ either.
TYPED_TEST(KernelsOf, RelaxationHasTheScalarBitsWithDenormalsFlushed) {
  using T = TypeParam;
  const detail::FlushDenormals flush;
  for (int round = 0; round < test::scaled(60); ++round)
    for (const Packing& packing : packings<T>(this->random)) {
      const Data<T> data(packing, this->random, Numbers::extreme);
      for (const Gradient gradient : all_gradients) {
        const Outcome<T> wanted = relax(kernels<T>(Isa::scalar), data, gradient, false);
        for (const Isa isa : vector_isas())
          ASSERT_TRUE(agree(packing, wanted.p, relax(kernels<T>(isa), data, gradient, false).p))
              << to_string(isa) << ", " << packing.shape << ", gradient " << to_string(gradient);
      }
    }
}

// One bad particle may reach those that rods tie it to, sweep by sweep, and no others: lanes are walls.
// Particles of an island of their own in the same vectors keep their bits.
TYPED_TEST(KernelsOf, ABrokenLaneLeavesTheOthersAlone) {
  using T = TypeParam;
  constexpr std::uint32_t lanes = logical_width<T>;
  // Four-link chains side by side, one per lane, and the same in one block with an address per rod.
  const std::uint32_t chains = 2 * lanes + 3, links = 4;
  layouts::LocalGraph g;
  for (std::uint32_t c = 0; c < chains; ++c)
    for (std::uint32_t i = 0; i < links; ++i)
      g.edges.push_back({c * (links + 1) + i, c * (links + 1) + i + 1});
  g.movable.assign(std::size_t{chains} * (links + 1), 1);
  const layouts::Islands islands = find_islands(g.view());
  ASSERT_EQ(islands.count(), chains);
  const layouts::LocalGraph local = local_graph(g.view(), islands, 0);
  const layouts::Coloring coloring = color_edges(local.view());
  std::vector<layouts::Piece> pieces;
  std::vector<layouts::IndexedPiece> indexed;
  for (std::uint32_t c = 0; c < chains; ++c) {
    pieces.push_back({c, islands.vertices(c), islands.edges(c)});
    indexed.push_back({pieces.back(), local.view(), coloring, {}});
  }
  const std::vector<std::uint8_t> common(g.edges.size(), 1);
  std::vector<Packing> list;
  list.push_back(pack_lanes(pieces, local.view(), coloring, std::vector<std::uint8_t>(links, 1), lanes));
  for (const auto layout : {layouts::Layout::aos, layouts::Layout::soa, layouts::Layout::aosoa})
    list.push_back(pack_indexed(indexed, layout, common, lanes, sizeof(T), "graph"));

  using Limits = std::numeric_limits<T>;
  std::vector<Isa> isas = vector_isas();
  isas.push_back(Isa::scalar);
  for (const Packing& packing : list)
    for (const T bad : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), Limits::max()})
      for (const Gradient gradient : all_gradients)
        for (const Isa isa : isas) {
          Data<T> data(packing, this->random, Numbers::ordinary);
          const Outcome<T> healthy = relax(kernels<T>(isa), data, gradient, false);
          const std::uint32_t victim =
              below(this->random, static_cast<std::uint32_t>(packing.slot_offset.size()));
          data.p[packing.slot_offset[victim] + packing.component_stride] = bad;
          const Outcome<T> poisoned = relax(kernels<T>(isa), data, gradient, false);
          bool harmed = false;
          for (std::size_t slot = 0; slot < packing.slot_offset.size(); ++slot)
            for (std::uint32_t c = 0; c < 3; ++c) {
              const std::size_t at = packing.slot_offset[slot] + c * packing.component_stride;
              if (packing.slot_island[slot] == packing.slot_island[victim]) {
                harmed = harmed || !same(healthy.p[at], poisoned.p[at]);
              } else {
                ASSERT_TRUE(same(healthy.p[at], poisoned.p[at])) << to_string(isa) << ", slot " << slot;
              }
            }
          EXPECT_TRUE(harmed);
        }
}

// The largest violation is that of the rods that have one; a rod that is not a number does not hide the
// others.
TYPED_TEST(KernelsOf, ViolationIgnoresWhatIsNotANumber) {
  using T = TypeParam;
  for (const Packing& packing : packings<T>(this->random)) {
    Data<T> data(packing, this->random, Numbers::ordinary);
    for (Range& range : data.ranges) range.uniform = false;
    BlockView<T> view = data.view();
    for (std::size_t slot = 0; slot < packing.slot_offset.size(); slot += 7)
      data.p[packing.slot_offset[slot]] = std::numeric_limits<T>::quiet_NaN();
    for (const Isa isa : vector_isas()) {
      const AccessKernels<T>& access = kernels<T>(isa).access[static_cast<int>(packing.access)];
      for (const Range range : data.ranges) {
        access.prepare(view, range);
        EXPECT_FALSE(std::isnan(access.violation(view, range)));
      }
    }
  }
}

TYPED_TEST(KernelsOf, ParticleLoopsHaveTheScalarBits) {
  using T = TypeParam;
  const ParticleKernels<T>& scalar = kernels<T>(Isa::scalar).particles;
  for (const Isa isa : vector_isas())
    for (int round = 0; round < test::scaled(200); ++round)
      for (const Numbers numbers : {Numbers::ordinary, Numbers::extreme, Numbers::broken}) {
        const ParticleKernels<T>& vector = kernels<T>(isa).particles;
        const std::uint32_t n = logical_width<T> * below(this->random, 20);  // none at all, too
        const T decay = T(1) - std::abs(number(this->random, Numbers::ordinary, T(0.5)));
        AlignedBuffer<T> x(n), p(n), u(n), kick(n), acc(n);
        for (AlignedBuffer<T>* field : {&x, &p, &u, &kick, &acc})
          for (std::uint32_t i = 0; i < n; ++i) (*field)[i] = number(this->random, numbers, T(1));

        EXPECT_EQ(scalar.all_finite(x.data(), p.data(), n), vector.all_finite(x.data(), p.data(), n));
        // f runs one loop on copies of x, p and acc; all that it writes is compared.
        const auto compare = [&](const char* loop, auto&& f) {
          AlignedBuffer<T> x1 = copy(x), p1 = copy(p), a1 = copy(acc), x2 = copy(x), p2 = copy(p),
                           a2 = copy(acc);
          f(scalar, x1.data(), p1.data(), a1.data());
          f(vector, x2.data(), p2.data(), a2.data());
          EXPECT_EQ(first_difference(x1, x2), -1) << loop << ", " << to_string(isa);
          EXPECT_EQ(first_difference(p1, p2), -1) << loop << ", " << to_string(isa);
          EXPECT_EQ(first_difference(a1, a2), -1) << loop << ", " << to_string(isa);
        };
        compare("predict",
                [&](const auto& k, T*, T* p_, T*) { k.predict(p_, u.data(), kick.data(), decay, n); });
        compare("accumulate", [&](const auto& k, T*, T* p_, T* acc_) { k.accumulate(p_, acc_, n); });
        compare("advance", [&](const auto& k, T* x_, T* p_, T*) { k.advance(x_, p_, n); });
        compare("advance_mid",
                [&](const auto& k, T* x_, T* p_, T*) { k.advance_mid(x_, p_, u.data(), decay, n); });
        compare("advance_mid_guarded", [&](const auto& k, T* x_, T* p_, T*) {
          k.advance_mid_guarded(x_, p_, kick.data(), decay, n);
        });
      }
}

TYPED_TEST(KernelsOf, CrowdLoopsHaveTheScalarBits) {
  using T = TypeParam;
  const Kernels<T>& scalar = kernels<T>(Isa::scalar);
  for (const Isa isa : vector_isas())
    for (int round = 0; round < test::scaled(200); ++round)
      for (const bool in_rows : {false, true}) {
        const CrowdKernels<T>&one = in_rows ? scalar.row_crowds : scalar.crowds,
              &many = in_rows ? kernels<T>(isa).row_crowds : kernels<T>(isa).crowds;
        const std::uint32_t n = (in_rows ? 3 * logical_width<T> : 4) * below(this->random, 20);
        AlignedBuffer<T> x(n), p(n), v(n), a(n);
        for (AlignedBuffer<T>* field : {&x, &p, &v, &a})
          for (std::uint32_t i = 0; i < n; ++i) (*field)[i] = number(this->random, Numbers::ordinary, T(1));
        AlignedBuffer<T> p1(n), p2(n), x1 = copy(x), x2 = copy(x), v1(n), v2(n);
        one.predict(p1.data(), v.data(), a.data(), T(0.1), T(0.01), n);
        many.predict(p2.data(), v.data(), a.data(), T(0.1), T(0.01), n);
        one.advance(x1.data(), v1.data(), p.data(), T(10), n);
        many.advance(x2.data(), v2.data(), p.data(), T(10), n);
        EXPECT_EQ(first_difference(p1, p2), -1) << to_string(isa);
        EXPECT_EQ(first_difference(x1, x2), -1) << to_string(isa);
        EXPECT_EQ(first_difference(v1, v2), -1) << to_string(isa);
        std::vector<double> mass(n);
        for (double& each : mass) each = std::abs(number(this->random, Numbers::ordinary, 1.0));
        EXPECT_EQ(one.weigh_squares(mass.data(), p.data(), n), many.weigh_squares(mass.data(), p.data(), n));
        EXPECT_EQ(one.farthest(p.data(), n), many.farthest(p.data(), n)) << to_string(isa);
        const FastRules<T> rules{{T(-1), T(-0.5), T(-1)}, {T(0.5), T(1), T(1)}, T(0.5)};
        std::vector<std::uint32_t> to1(n), to2(n);
        to1.resize(one.list_fast(x.data(), p.data(), rules, n, to1.data()));
        to2.resize(many.list_fast(x.data(), p.data(), rules, n, to2.data()));
        EXPECT_EQ(to1, to2) << to_string(isa);
      }
}

// Wherever the one bad number stands.
TYPED_TEST(KernelsOf, AllFiniteFindsEveryPlace) {
  using T = TypeParam;
  std::vector<Isa> isas = vector_isas();
  isas.push_back(Isa::scalar);
  for (const Isa isa : isas)
    for (const T bad : {std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity(),
                        std::numeric_limits<T>::quiet_NaN()}) {
      const std::uint32_t n = 3 * logical_width<T>;
      const AlignedBuffer<T> x(n);
      AlignedBuffer<T> p(n);
      for (std::uint32_t i = 0; i < n; ++i) p[i] = std::numeric_limits<T>::max();
      EXPECT_TRUE(kernels<T>(isa).particles.all_finite(x.data(), p.data(), n));
      for (std::uint32_t i = 0; i < n; ++i) {
        std::swap(p[i], p[0]);
        const T kept = std::exchange(p[i], bad);
        EXPECT_FALSE(kernels<T>(isa).particles.all_finite(x.data(), p.data(), n))
            << to_string(isa) << ", " << i;
        p[i] = kept;
      }
    }
}

// Numbers that a reader can check: a rod of 1 m stretched by 10 % between equal masses comes back to its
// length in one projection. Its residual is cubic, a quarter of the strain cubed: 2.5e-4.
TYPED_TEST(KernelsOf, AStretchedRodComesBack) {
  using T = TypeParam;
  std::vector<Isa> isas = vector_isas();
  isas.push_back(Isa::scalar);
  for (const Isa isa : isas) {
    const Packing packing = chain_packing(1, logical_width<T>, sizeof(T), true);
    Data<T> data(packing, this->random, Numbers::ordinary);
    const std::uint32_t a = packing.slot_offset[0], b = packing.slot_offset[1];
    for (AlignedBuffer<T>* field : {&data.x, &data.p})
      for (std::size_t i = 0; i < field->size(); ++i) (*field)[i] = 0;
    data.x[b] = T(1.1);  // a at the origin, b 1.1 m along x
    for (std::size_t i = 0; i < packing.lane_edge.size(); ++i)
      if (packing.lane_edge[i] != none) {
        T* fields =
            data.weight.data() + i / Data<T>::width * weight_fields * Data<T>::width + i % Data<T>::width;
        fields[0] = fields[3 * Data<T>::width] = 1;
        fields[Data<T>::width] = fields[2 * Data<T>::width] = T(0.125);  // omega/4 * w/(w + w)
      }
    for (Range& range : data.ranges) range.uniform = false;
    const BlockView<T> view = data.view();
    const AccessKernels<T>& access = kernels<T>(isa).access[static_cast<int>(packing.access)];
    T largest = 0;
    for (const Range range : data.ranges) {
      access.prepare(view, range);
      largest = std::max(largest, access.violation(view, range));
    }
    EXPECT_NEAR(largest, 0.21, 1e-6);  // 1.1^2 - 1
    access.sweep[0](view, data.ranges.data(), static_cast<std::uint32_t>(data.ranges.size()));
    EXPECT_NEAR(data.x[b] + data.p[b] - data.p[a], 1, 3e-4);
    EXPECT_EQ(data.p[b], -data.p[a]);
  }
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
