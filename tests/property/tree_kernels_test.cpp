// One call of each kernel of the direct solve against the same equations written out as one dense matrix, on
// random trees; and every instruction set, every lane and a tree alone against the scalar bits.

#include "simd/tree/tree_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "direct/trees/tree_state.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/trees.hpp"
#include "support/dense_solves.hpp"
#include "support/graphs.hpp"
#include "support/random_trees.hpp"
#include "support/sanitizers.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

using detail::TreeState;
using detail::TreeTopology;
using detail::TreeWorkspace;
using test::below;
using test::Random;
using test::signed_unit;

using test::Real;
using Matrix = test::DenseMatrix;
using Vector = test::DenseVector;
using Vector3 = Eigen::Matrix<Real, 3, 1>;

/// The one island of a scene, as the simulation finds it.
struct Island {
  explicit Island(const Scene& scene) {
    std::vector<layouts::Edge> edges;
    for (const Rod& rod : scene.rods) edges.push_back({rod.a, rod.b});
    std::vector<std::uint8_t> movable;
    for (const Particle& particle : scene.particles) movable.push_back(!particle.fixed);
    const layouts::Graph graph{static_cast<std::uint32_t>(movable.size()), edges, movable};
    islands = find_islands(graph);
    tree = *find_tree(local_graph(graph, islands, 0).view());
    topology = std::make_shared<const TreeTopology>(tree);
  }
  layouts::Islands islands;
  layouts::Tree tree;
  std::shared_ptr<const TreeTopology> topology;
};

/// A tree, or as many as fit in lanes, in the midst of a substep: everything that a kernel may read is
/// random.
template <class T>
struct Midst {
  Midst(const Island& island_, std::uint32_t lanes)
      : island(&island_), state(island_.topology, lanes), work(*island_.topology, lanes) {}

  /// mu is kept below what would let some particle weigh nothing (TreeView: M - theta mu).
  void fill(std::uint32_t lane, const Scene& scene, MassModel model, Random& random) {
    state.fill_lane(lane, scene, model, island->tree,
                    {island->islands.vertices(0), island->islands.edges(0)});
    double least = 1e300;
    for (std::uint32_t i = 0; i < state.topology->nodes; ++i)
      least = std::min(least, static_cast<double>(state.node[state.at(tree_fields::node * i, lane)]));
    const auto scatter = [&](auto& field, double size) {
      for (std::size_t i = lane; i < field.size(); i += state.lanes)
        field[i] = static_cast<T>(size * signed_unit(random));
    };
    scatter(state.u, 0.1);
    scatter(state.acceleration, 10);
    scatter(state.acceleration_before, 10);
    scatter(state.tie_delta, 0.03);
    scatter(state.tie_u, 0.03);
    scatter(state.mu, 1);
    scatter(state.tie_mu, 1);
    scatter(state.mu_before, 1);
    scatter(state.tie_mu_before, 1);
    for (auto* field : {&state.mu, &state.tie_mu, &state.mu_before, &state.tie_mu_before})
      for (std::size_t i = lane; i < field->size(); i += state.lanes)
        (*field)[i] = static_cast<T>((*field)[i] > 0 ? 0.05 * least * (*field)[i] : (*field)[i]);
    work.ratio[lane] = static_cast<T>(0.9 + 0.2 * signed_unit(random));
    work.kick[lane] = static_cast<T>(2e-3 * (1 + std::abs(signed_unit(random))));
    work.inverse_kick[lane] = 1 / work.kick[lane];
    work.guess[lane] = static_cast<T>(1e-3 * signed_unit(random));
    work.guess_before[lane] = static_cast<T>(1e-3 * signed_unit(random));
    work.mu_scale[lane] = 1;
    work.mu_scale_before[lane] = static_cast<T>(0.5 * std::abs(signed_unit(random)));
    work.u_delta[lane] = static_cast<T>(1 + 0.5 * signed_unit(random));
    work.u_before[lane] = static_cast<T>(signed_unit(random));
    work.active[lane] = 1;
  }
  TreeView<T> view() { return work.view(state); }

  const Island* island;
  TreeState<T> state;
  TreeWorkspace<T> work;
};

/// The equations of a tree alone, from the description of TreeView, particle by particle.
class Dense {
 public:
  explicit Dense(const TreeView<double>& tree) : tree_(tree), n_(3 * tree.nodes), rods_(tree.nodes - 1) {
    ties_ = tree.tie_begin[tree.nodes];
    for (std::uint32_t i = 0; i < tree.nodes; ++i)
      for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k) holder_.push_back(i);
    mass_ = Matrix::Zero(n_, n_);
    for (std::uint32_t i = 0; i < tree.nodes; ++i) {
      add(mass_, i, i, tree.node[tree_fields::node * i]);
      if (i == 0) continue;
      add(mass_, i, tree.parent[i], tree.node[tree_fields::node * i + 1]);
      add(mass_, tree.parent[i], i, tree.node[tree_fields::node * i + 1]);
    }
  }

  Eigen::Index constraints() const { return rods_ + ties_; }
  /// Node i at the first end, and at the other its parent, or none (-1) for a tie.
  std::pair<Eigen::Index, Eigen::Index> ends(Eigen::Index c) const {
    if (c < rods_) return {c + 1, tree_.parent[c + 1]};
    return {holder_[static_cast<std::size_t>(c - rods_)], -1};
  }
  Vector3 rod(Eigen::Index c) const {
    const auto [i, p] = ends(c);
    return c < rods_ ? at(tree_.x, i) - at(tree_.x, p) : at(tree_.x, i) - at(tree_.tie_x, c - rods_);
  }
  Vector3 stretching(Eigen::Index c) const {  // e
    const auto [i, p] = ends(c);
    return at(tree_.delta, i) - (c < rods_ ? at(tree_.delta, p) : at(tree_.tie_delta, c - rods_));
  }
  Real multiplier(Eigen::Index c) const { return c < rods_ ? tree_.mu[c + 1] : tree_.tie_mu[c - rods_]; }
  Vector multipliers() const {
    Vector all(constraints());
    for (Eigen::Index c = 0; c < all.size(); ++c) all[c] = multiplier(c);
    return all;
  }
  Real length2(Eigen::Index c) const {
    return c < rods_ ? tree_.length2[c + 1] : tree_.tie_length2[c - rods_];
  }
  /// Sum over ties of their coupling to the displacement of the fixed end.
  Vector tied(const double* displacement) const {
    Vector sum = Vector::Zero(n_);
    for (Eigen::Index k = 0; k < ties_; ++k)
      sum.segment<3>(3 * holder_[static_cast<std::size_t>(k)]) +=
          Real{tree_.tie[tree_fields::tie * k]} * at(displacement, k);
    return sum;
  }
  Vector all(const double* field) const {
    Vector v(n_);
    for (Eigen::Index i = 0; i < n_; ++i) v[i] = field[i];
    return v;
  }
  Vector load() const {
    return tree_.ratio[0] * (mass_ * all(tree_.u)) + tied(tree_.tie_u) +
           Real{tree_.kick[0]} * all(tree_.force);
  }

  /// Changes of delta, then of the multipliers of rods and ties.
  Vector newton(Real theta) const {
    Matrix matrix = Matrix::Zero(n_ + constraints(), n_ + constraints());
    Vector right = Vector::Zero(n_ + constraints());
    matrix.topLeftCorner(n_, n_) = mass_;
    right.head(n_) = load() - mass_ * all(tree_.delta) - tied(tree_.tie_delta);
    for (Eigen::Index c = 0; c < constraints(); ++c) {
      const auto [i, p] = ends(c);
      const Vector3 d = rod(c), e = stretching(c), a = d + theta * e, b = d + e;
      const Real mu = multiplier(c);
      put_rod(matrix, c, -a, b);
      add(matrix, i, i, -theta * mu);
      right.segment<3>(3 * i) += mu * a;
      if (p >= 0) {
        add(matrix, p, p, -theta * mu);
        add(matrix, i, p, theta * mu);
        add(matrix, p, i, theta * mu);
        right.segment<3>(3 * p) -= mu * a;
      }
      right[n_ + c] = -(b.squaredNorm() - length2(c)) / 2;
    }
    return test::solve_dense(matrix, right);
  }

  /// delta' of M delta' = M delta + kick force + J^T lambda, J delta' = 0, ties from tie_u to tie_delta.
  Vector project() const {
    Matrix matrix = Matrix::Zero(n_ + constraints(), n_ + constraints());
    Vector right = Vector::Zero(n_ + constraints());
    matrix.topLeftCorner(n_, n_) = mass_;
    right.head(n_) = mass_ * all(tree_.delta) + tied(tree_.tie_u) - tied(tree_.tie_delta) +
                     Real{tree_.kick[0]} * all(tree_.force);
    for (Eigen::Index c = 0; c < constraints(); ++c) {
      put_rod(matrix, c, -rod(c), rod(c));
      if (c >= rods_) right[n_ + c] = rod(c).dot(at(tree_.tie_delta, c - rods_));
    }
    return test::solve_dense(matrix, right).head(n_);
  }

  /// The largest eigenvalue of M^-1 K, K what |mu| in every rod makes of displacements across it.
  double stiffest() const {
    Matrix stiffness = Matrix::Zero(n_, n_);
    for (Eigen::Index c = 0; c < constraints(); ++c) {
      const auto [i, p] = ends(c);
      const Real pull = std::abs(multiplier(c));
      add(stiffness, i, i, pull);
      if (p < 0) continue;
      add(stiffness, p, p, pull);
      add(stiffness, i, p, -pull);
      add(stiffness, p, i, -pull);
    }
    return test::largest_eigenvalue(stiffness, mass_);
  }

  /// Whether no rod is redundant or nearly so: the least pivot of J J^T, rows of length 1.
  bool well_posed() const {
    Matrix rates = Matrix::Zero(constraints(), n_);
    for (Eigen::Index c = 0; c < constraints(); ++c) {
      const auto [i, p] = ends(c);
      const Vector3 unit = rod(c).normalized();
      rates.block<1, 3>(c, 3 * i) = unit.transpose();
      if (p >= 0) rates.block<1, 3>(c, 3 * p) = -unit.transpose();
    }
    return constraints() == 0 || test::least_eigenvalue(rates * rates.transpose()) > 1e-3;
  }

 private:
  static Vector3 at(const double* field, Eigen::Index i) {
    return {field[3 * i], field[3 * i + 1], field[3 * i + 2]};
  }
  static void add(Matrix& matrix, Eigen::Index i, Eigen::Index j, Real value) {
    for (Eigen::Index k = 0; k < 3; ++k) matrix(3 * i + k, 3 * j + k) += value;
  }
  void put_rod(Matrix& matrix, Eigen::Index c, const Vector3& force, const Vector3& gradient) const {
    const auto [i, p] = ends(c);
    matrix.block<3, 1>(3 * i, n_ + c) += force;
    matrix.block<1, 3>(n_ + c, 3 * i) += gradient.transpose();
    if (p < 0) return;
    matrix.block<3, 1>(3 * p, n_ + c) -= force;
    matrix.block<1, 3>(n_ + c, 3 * p) -= gradient.transpose();
  }

  TreeView<double> tree_;
  Eigen::Index n_, rods_, ties_ = 0;
  std::vector<Eigen::Index> holder_;
  Matrix mass_;
};

Real apart(const Vector& a, const Vector& b) {
  return (a - b).norm() / b.norm();
}

struct Case {
  test::TreeShape shape;
  MassModel model;
};
Case random_case(Random& random, double masses) {
  const bool consistent = below(random, 2) == 0;
  return {{.movable = 1 + below(random, 14),
           .anchors = below(random, 5),
           .masses = masses,
           .rod_mass = consistent ? masses / 10 : 0,
           .straggling = below(random, 2) == 0},
          consistent ? MassModel::consistent : MassModel::lumped};
}

// To 1e-10 of the solution where masses lie within a factor of 100 and at most one tie holds the tree. Beyond
// that, blocks of light particles above heavy ones, or with two ties, are stiff along rods and soft across;
// inverting them by cofactors loses up to the square of that ratio, which the next Newton step makes good.
// Measured over fourteen seeds: 1e-14 and, with masses of 1e-3 to 1e3 kg and ties, 1e-9 for 9 of 10, 3e-5 for
// 99 of 100; of one tree in 3,000, held by six ties or so, the multipliers are anything (conditions of 1e6).
TEST(TreeKernels, NewtonIsTheDenseStep) {
  Random random(11);
  int solved = 0;
  std::vector<Real> hard;
  for (int round = 0; round < test::scaled(800); ++round) {
    const bool easy = round % 2 == 0;
    Case kind = random_case(random, easy ? 10 : 1e3);
    if (easy) kind.shape.anchors %= 2;
    const Scene scene = test::random_tree(random, kind.shape);
    const Island island(scene);
    Midst<double> midst(island, 1);
    midst.fill(0, scene, kind.model, random);
    const TreeView<double> view = midst.view();
    tree_kernels<double>(Isa::scalar).prepare(view);
    const Dense dense(view);
    if (!dense.well_posed()) continue;
    ++solved;
    ASSERT_LE((dense.all(view.load) - dense.load()).norm(), 1e-14L * (1 + dense.load().norm()));
    // Off the first guess, so that it is no special point.
    for (std::size_t i = 0; i < midst.work.delta.size(); ++i)
      midst.work.delta[i] += 0.02 * signed_unit(random);

    constexpr Real thetas[] = {0, 0.5L, 1, 0.3125L};
    const Real theta = thetas[round / 2 % 4];
    const Vector wanted = dense.newton(theta), before = dense.all(view.delta);
    const Vector mu = dense.multipliers();
    tree_kernels<double>(Isa::scalar).newton(view, static_cast<double>(theta));
    const Vector got = dense.all(view.delta) - before, pulled = dense.multipliers() - mu;
    const Eigen::Index n = before.size(), m = dense.constraints();
    const Real far = std::max(apart(got, wanted.head(n)), m > 0 ? apart(pulled, wanted.tail(m)) : 0);
    if (!easy) {
      ASSERT_TRUE(std::isfinite(far)) << "round " << round;
      hard.push_back(far);
      continue;
    }
    ASSERT_LE(far, 1e-10L) << "round " << round << ", theta " << theta;
    ASSERT_NEAR(midst.work.change[0], static_cast<double>(wanted.head(n).squaredNorm()),
                1e-9 * midst.work.change[0]);
  }
  EXPECT_GT(solved, test::scaled(400));
  std::sort(hard.begin(), hard.end());
  EXPECT_LE(hard[hard.size() / 2], 1e-12L);
  EXPECT_LE(hard[hard.size() * 9 / 10], 1e-8L);
  EXPECT_LE(hard[hard.size() * 99 / 100], 1e-4L);
}

// The same for velocities. Where ties are redundant, velocities are unique all the same, if the ties rest.
TEST(TreeKernels, ProjectIsTheDenseProjection) {
  Random random(12);
  for (int round = 0; round < test::scaled(400); ++round) {
    Case kind = random_case(random, 10);
    const bool redundant = round % 4 == 0;  // all eight hold one particle, or two
    if (redundant) kind = {{.movable = 1, .anchors = 8, .ties = 8, .masses = 10}, MassModel::lumped};
    const Scene scene = test::random_tree(random, kind.shape);
    const Island island(scene);
    Midst<double> midst(island, 1);
    midst.fill(0, scene, kind.model, random);
    if (redundant) std::fill_n(midst.state.tie_delta.data(), midst.state.tie_delta.size(), 0.0);
    const TreeView<double> view = midst.view();
    tree_kernels<double>(Isa::scalar).prepare(view);
    const Dense dense(view);
    if (!redundant && !dense.well_posed()) continue;
    const Vector wanted = dense.project(), before = dense.all(view.delta);
    tree_kernels<double>(Isa::scalar).project(view);
    const Real tolerance = kind.shape.anchors <= 1 ? 1e-10L : 1e-6L;
    ASSERT_LE((dense.all(view.delta) - wanted).norm(), tolerance * before.norm())
        << "round " << round << (redundant ? ", redundant" : "");
  }
}

// No wave across rods is faster than the bound, whatever hangs where, with rods that have mass of their own
// in their ends or in their middle.
TEST(TreeKernels, StiffnessIsABound) {
  Random random(15);
  std::vector<double> loose;
  for (int round = 0; round < test::scaled(400); ++round) {
    Case kind = random_case(random, round % 2 == 0 ? 10 : 1e3);
    Scene scene = test::random_tree(random, kind.shape);
    for (Rod& rod : scene.rods) {
      const double length = norm(scene.particles[rod.b].position - scene.particles[rod.a].position);
      if (kind.model == MassModel::consistent && below(random, 2) == 0)
        rod.inertia = rod.mass * length * length / (13 + 30 * std::abs(signed_unit(random)));
    }
    const Island island(scene);
    Midst<double> midst(island, 1);
    midst.fill(0, scene, kind.model, random);
    const TreeView<double> view = midst.view();
    tree_kernels<double>(Isa::scalar).find_stiffness(view);
    const double stiffest = Dense(view).stiffest();
    ASSERT_LE(stiffest, (1 + 1e-9) * midst.work.stiffness[0]) << "round " << round;
    if (stiffest > 0) loose.push_back(midst.work.stiffness[0] / stiffest);
  }
  // What is too high costs substeps, by its root (2.0 in the middle, 2.6 for nine of ten seen).
  std::sort(loose.begin(), loose.end());
  EXPECT_LE(loose[loose.size() / 2], 2.2);
  EXPECT_LE(loose[loose.size() * 9 / 10], 3);
}

template <class T>
bool same(T a, T b) {
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

/// Everything that a substep leaves behind in one lane.
template <class T>
std::vector<double> outcome(Midst<T>& midst, std::uint32_t lane) {
  std::vector<double> numbers;
  const auto take = [&](const auto& field) {
    for (std::size_t i = lane; i < field.size(); i += midst.state.lanes)
      numbers.push_back(static_cast<double>(field[i]));
  };
  take(midst.state.x);
  for (const auto* field :
       {&midst.state.u, &midst.state.acceleration, &midst.state.acceleration_before, &midst.state.mu,
        &midst.state.tie_mu, &midst.state.mu_before, &midst.state.tie_mu_before})
    take(*field);
  for (const auto* field : {&midst.work.delta, &midst.work.load, &midst.work.change, &midst.work.push,
                            &midst.work.jolt, &midst.work.stiffness})
    take(*field);
  return numbers;
}

template <class T>
void substep(Midst<T>& midst, const TreeKernels<T>& kernels, T theta) {
  const TreeView<T> view = midst.view();
  kernels.prepare(view);
  kernels.newton(view, theta);
  kernels.newton(view, theta);
  kernels.find_stiffness(view);
  kernels.advance(view);
  kernels.project(view);
}

template <class T>
class TreeKernelsOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
struct PrecisionName {
  template <class T>
  static std::string GetName(int) {
    return sizeof(T) == 4 ? "Float" : "Double";
  }
};
TYPED_TEST_SUITE(TreeKernelsOf, Precisions, PrecisionName);

// Different trees of one shape in the lanes, some lanes at rest: whatever the instruction set and the lane,
// the bits of the same tree alone.
TYPED_TEST(TreeKernelsOf, HaveTheSameBitsOnEveryInstructionSetInAnyLaneAndAlone) {
  using T = TypeParam;
  constexpr std::uint32_t lanes = logical_width<T>;
  Random random(13);
  for (int round = 0; round < test::scaled(60); ++round) {
    const Case kind = random_case(random, round % 2 == 0 ? 1e3 : 10);
    Scene scene = test::random_tree(random, kind.shape);
    const Island island(scene);
    const T theta = round % 3 == 0 ? T(0) : round % 3 == 1 ? T(0.5) : T(1);
    std::vector<std::vector<double>> wanted;
    std::vector<Random> seeds;
    std::vector<Scene> scenes;
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      for (Particle& particle : scene.particles) particle.position += 0.05 * test::random_vector(random);
      scenes.push_back(scene);
      seeds.push_back(random);
      Midst<T> alone(island, 1);
      alone.fill(0, scene, kind.model, random);
      if (lane % 5 == 3) alone.work.active[0] = 0;
      substep(alone, tree_kernels<T>(Isa::scalar), theta);
      wanted.push_back(outcome(alone, 0));
    }
    for (const Isa isa : all_isas()) {
      if (!is_supported(isa)) continue;
      Midst<T> together(island, lanes);
      for (std::uint32_t lane = 0; lane < lanes; ++lane) {
        Random seed = seeds[lane];
        together.fill(lane, scenes[lane], kind.model, seed);
        if (lane % 5 == 3) together.work.active[lane] = 0;
      }
      substep(together, tree_kernels<T>(isa), theta);
      for (std::uint32_t lane = 0; lane < lanes; ++lane) {
        const std::vector<double> got = outcome(together, lane);
        ASSERT_EQ(got.size(), wanted[lane].size());
        for (std::size_t i = 0; i < got.size(); ++i)
          ASSERT_TRUE(same(got[i], wanted[lane][i])) << to_string(isa) << ", lane " << lane << ", number "
                                                     << i << ": " << got[i] << " and " << wanted[lane][i];
      }
    }
  }
}

// A lane that is not a number leaves the others alone.
TYPED_TEST(TreeKernelsOf, ABrokenLaneLeavesTheOthersAlone) {
  using T = TypeParam;
  constexpr std::uint32_t lanes = logical_width<T>;
  Random random(14);
  const Scene scene = test::random_tree(random, {.movable = 9, .anchors = 2});
  const Island island(scene);
  for (const Isa isa : all_isas()) {
    if (!is_supported(isa)) continue;
    Midst<T> whole(island, lanes), broken(island, lanes);
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      Random seed(lane), again(lane);
      whole.fill(lane, scene, MassModel::lumped, seed);
      broken.fill(lane, scene, MassModel::lumped, again);
    }
    broken.state.u[broken.state.at(4, 2)] = std::numeric_limits<T>::quiet_NaN();
    broken.state.force[broken.state.at(7, lanes - 1)] = std::numeric_limits<T>::infinity();
    substep(whole, tree_kernels<T>(isa), T(0.5));
    substep(broken, tree_kernels<T>(isa), T(0.5));
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      if (lane == 2 || lane == lanes - 1) continue;
      const std::vector<double> a = outcome(whole, lane), b = outcome(broken, lane);
      for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(same(a[i], b[i])) << to_string(isa) << lane;
    }
  }
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
