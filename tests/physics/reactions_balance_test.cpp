// Reactions, gravity and the change of momentum balance on random scenes of every kind, in whatever pieces
// steps are taken.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/random_trees.hpp"
#include "support/reactions.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::movable;
using test::Random;
using test::sum_of_reactions;

/// Says what random scenes of a kind have.
struct Kind {
  const char* name;
  bool branches = false, elastic = false, cables = false, bends = false, twist = false, loops = false,
       tackle = false, mass = false;

  friend std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }
};

// Those whose rods have mass come last.
constexpr Kind kinds[] = {
    {.name = "trees", .branches = true},
    {.name = "elastic_trees", .branches = true, .elastic = true},
    {.name = "cables", .branches = true, .elastic = true, .cables = true},
    {.name = "bent_lines", .bends = true},
    {.name = "twisted_lines", .bends = true, .twist = true},
    {.name = "loops", .branches = true, .loops = true},
    {.name = "all", .branches = true, .elastic = true, .bends = true, .loops = true, .tackle = true},
    {.name = "trees_with_mass", .branches = true, .mass = true},
    {.name = "bent_trees_with_mass", .branches = true, .bends = true, .mass = true},
    {.name = "loops_with_mass", .branches = true, .loops = true, .mass = true},
};
constexpr std::size_t massless_kinds = 7;

double between(Random& random, double least, double most) {
  return least * std::pow(most / least, 0.5 + 0.5 * test::signed_unit(random));
}

/// Six particles hang from an anchor, in motion.
Scene random_hanging(const Kind& kind, Random& random) {
  constexpr std::uint32_t particles = 6;
  Scene scene;
  scene.particles.push_back(fixed({}));
  const auto law = [&] {
    RodLaw out;
    if (kind.elastic) out.stiffness = between(random, 10, 1e6);
    if (kind.cables) out.one_sided = test::below(random, 2) == 0;
    return out;
  };
  std::vector<std::uint32_t> parents{0};
  for (std::uint32_t i = 1; i <= particles; ++i) {
    parents.push_back(kind.branches ? test::below(random, i) : i - 1);
    Vec3 way = test::random_vector(random);
    while (norm(way) < 0.3) way = test::random_vector(random);
    const Vec3 at = scene.particles[parents[i]].position + between(random, 0.2, 0.6) / norm(way) * way;
    scene.particles.push_back(movable(at, between(random, 0.1, 2), test::random_vector(random)));
    scene.rods.push_back({.a = parents[i], .b = i, .mass = kind.mass ? 0.3 : 0, .law = law()});
    if (kind.bends && parents[i] != 0)
      scene.bends.push_back({.a = parents[parents[i]],
                             .b = parents[i],
                             .c = i,
                             .stiffness = between(random, 0.1, 10),
                             .angle = 0.3});
  }
  if (kind.twist) scene.twists = {{.particles = {0, 1, 2, 3, 4, 5, 6}, .stiffness = 1, .angle = 2}};
  if (kind.loops) {  // one that stays a loop, since its other rods are not tied to the anchor
    scene.particles.push_back(movable(scene.particles[6].position + Vec3{0.2, 0.1, 0.3}, 0.3));
    scene.rods.push_back({.a = 6, .b = 7, .mass = kind.mass ? 0.2 : 0, .law = law()});
    scene.rods.push_back({.a = parents[6] == 0 ? 5u : parents[6], .b = 7, .law = {.stiffness = 100}});
  }
  if (kind.tackle) {
    scene.particles.push_back(fixed({0.5, 1, 0.2}));
    scene.tackles = {{.particles = {8, 2, 8, 4}, .law = {.stiffness = 40}}};
  }
  return scene;
}

/// Steps a world, moves its anchors by jerks if it is to, and says what is left of the balance.
class Balance {
 public:
  Balance(const Scene& scene, const Settings& settings, double dt, bool jerks)
      : world_(scene, settings), scene_(scene), model_(mass_model_of(settings)), dt_(dt), jerks_(jerks) {
    velocity_.resize(scene.particles.size());
    for (const Particle& particle : scene.particles)
      if (!particle.fixed) mass_ += particle.mass;
    for (const Rod& rod : scene.rods) mass_ += rod.mass;
  }

  /// Takes a step. Returns by how much the balance is off, as a share of the largest force or pull.
  double step() {
    const Vec3 before = momentum(), middle_before = middle_momentum_;
    const std::vector<Vec3> from = test::positions_of(world_);
    for (std::uint32_t i = 0; jerks_ && i < scene_.particles.size(); ++i) {
      if (!scene_.particles[i].fixed) continue;
      const Vec3 velocity = (number_ % 5 == 0 ? -1 : 1) * std::sin(0.3 * number_) * Vec3{0.3, 0.2, -0.2};
      world_.move_anchor(i, world_.position(i) + dt_ * velocity);
      velocity_[i] = velocity;
    }
    ++number_;
    report = world_.step(dt_);
    middle_momentum_ = {};
    for (std::uint32_t i = 0; i < from.size(); ++i)
      if (!scene_.particles[i].fixed)
        middle_momentum_ += scene_.particles[i].mass / dt_ * (world_.position(i) - from[i]);
    const Vec3 held = sum_of_reactions(world_) + mass_ * scene_.gravity;
    double largest = mass_ * norm(scene_.gravity);
    for (std::uint32_t i = 0; i < scene_.particles.size(); ++i)
      if (scene_.particles[i].fixed) largest = std::max(largest, norm(world_.reaction(i)));
    for (std::uint32_t i = 0; i < scene_.rods.size(); ++i)
      largest = std::max(largest, std::abs(world_.tension(i)));
    off_in_the_middle = norm(1 / dt_ * (middle_momentum_ - middle_before) - held) / largest;
    return norm(1 / dt_ * (momentum() - before) - held) / largest;
  }

  /// Returns whether every island took one substep in the last step.
  bool is_uncut() const { return report.direct_substeps == world_.info().islands && report.fallbacks == 0; }

  StepReport report;
  /// The same for particles' displacements over dt, of massless rods.
  double off_in_the_middle = 0;

 private:
  /// Anchors have what rods' mass there has.
  Vec3 momentum() const {
    std::vector<Vec3> velocities = test::velocities_of(world_);
    Vec3 sum;
    for (std::uint32_t i = 0; i < velocities.size(); ++i)
      if (scene_.particles[i].fixed) velocities[i] = velocity_[i];
    for (std::size_t i = 0; i < scene_.rods.size(); ++i) {
      const auto [a, b] = std::pair{scene_.rods[i].a, scene_.rods[i].b};
      const RodMass mass = rod_mass(scene_, i, model_);
      if (scene_.particles[a].fixed) sum += mass.aa * velocities[a];
      if (scene_.particles[b].fixed) sum += mass.bb * velocities[b];
    }
    return sum + measure_momentum(scene_, test::positions_of(world_), velocities, model_).linear;
  }

  World world_;
  const Scene& scene_;
  MassModel model_;
  double dt_, mass_ = 0;
  bool jerks_;
  std::uint32_t number_ = 0;
  std::vector<Vec3> velocity_;  ///< Of anchors in the last step, m/s.
  Vec3 middle_momentum_;
};

constexpr std::uint32_t scenes_of_kind = 5, steps = 50;

class ReactionsBalance : public testing::TestWithParam<Kind> {};
class MasslessReactionsBalance : public ReactionsBalance {};
class ReactionsBalanceOfRods : public ReactionsBalance {};  // gradient old refuses bends and tackles

// Newton's method ends where its next change would be a hundred-millionth of a rod. That times a change of
// multipliers is what forces may be off by then, mostly 1e-14.
void expect_balance(const Kind& kind, Gradient gradient) {
  std::uint64_t cut = 0, compared = 0;
  for (const std::uint32_t substeps : {1u, 3u, 8u})
    for (const bool jerks : {false, true}) {
      Random random(17);
      for (std::uint32_t number = 0; number < scenes_of_kind; ++number) {
        const Scene scene = random_hanging(kind, random);
        Balance balance(scene,
                        {.method = Method::direct,
                         .precision = Precision::double_,
                         .gradient = gradient,
                         .substeps = substeps,
                         .tensions = true},
                        1.0 / 15, jerks);
        for (std::uint32_t i = 0; i < steps; ++i) {
          const double off = balance.step();
          cut += balance.report.halvings;
          // Elastic substeps end near their solution alone, and damped ones have another velocity.
          if (balance.report.elastic_substeps > 0 || balance.report.fallbacks > 0) continue;
          ++compared;
          ASSERT_LT(off, 1e-8) << number << ", " << substeps << " substeps, step " << i << jerks;
        }
      }
    }
  EXPECT_GT(cut, 0u) << "no substep was cut";
  EXPECT_GT(compared, 3 * scenes_of_kind * steps) << "of twice as many";
}

TEST_P(ReactionsBalance, ToRoundingWithGradientMid) {
  expect_balance(GetParam(), Gradient::mid);
}

TEST_P(ReactionsBalanceOfRods, ToRoundingWithGradientOld) {
  expect_balance(GetParam(), Gradient::old);
}

// A pull of gradient new is that of the end of a substep. It changes displacements of substeps, which stand
// for velocities in their middle. What rods' mass asks of anchors is known from velocities at the ends of a
// step.
TEST_P(MasslessReactionsBalance, DisplacementsToRoundingWithGradientNew) {
  Random random(18);
  double worst = 0;
  for (std::uint32_t number = 0; number < scenes_of_kind; ++number) {
    const Scene scene = random_hanging(GetParam(), random);
    Balance balance(scene,
                    {.method = Method::direct,
                     .precision = Precision::double_,
                     .gradient = Gradient::new_,
                     .tensions = true},
                    1.0 / 480, false);
    std::uint32_t whole = 0;  // so many steps in a row were not cut
    for (std::uint32_t i = 0; i < steps; ++i) {
      balance.step();
      whole = balance.is_uncut() ? whole + 1 : 0;
      // The first step starts from velocities.
      if (whole >= 2 && i > 1) worst = std::max(worst, balance.off_in_the_middle);
    }
  }
  // Differences of places round by 1e-16 m / dt^2 times kilograms, of newtons.
  EXPECT_LT(worst, 1e-8);
  EXPECT_GT(worst, 0) << "no two steps in a row were not cut";
}

// A world of one substep a step comes to the same places, so that its reactions must have the same mean.
TEST_P(ReactionsBalance, AreTheMeanOfThoseOfSubsteps) {
  const Kind& kind = GetParam();
  constexpr std::uint32_t substeps = 4;
  constexpr double dt = 1.0 / 120;
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    if (gradient == Gradient::old && (kind.bends || kind.tackle)) continue;
    std::uint32_t compared = 0;
    Random random(19);
    for (std::uint32_t number = 0; number < scenes_of_kind; ++number) {
      const Scene scene = random_hanging(kind, random);
      Settings settings{.method = Method::direct,
                        .precision = Precision::double_,
                        .gradient = gradient,
                        .substeps = substeps,
                        .tensions = true};
      World all(scene, settings);
      settings.substeps = 1;
      World each(scene, settings);
      for (std::uint32_t i = 0; i < steps; ++i) {
        all.step(dt);
        Vec3 mean;
        double largest = 1;
        for (std::uint32_t k = 0; k < substeps; ++k) {
          each.step(dt / substeps);
          mean += 1.0 / substeps * each.reaction(0);
          largest = std::max(largest, norm(each.reaction(0)));
        }
        if (all.state_hash() != each.state_hash()) break;
        ++compared;
        ASSERT_LT(norm(all.reaction(0) - mean), 1e-12 * largest) << number << ", step " << i;
      }
    }
    EXPECT_EQ(compared, scenes_of_kind * steps) << to_string(gradient) << " came to other places";
  }
}

std::string name_of(const testing::TestParamInfo<Kind>& param) {
  return param.param.name;
}
INSTANTIATE_TEST_SUITE_P(Every, ReactionsBalance, testing::ValuesIn(kinds), name_of);
INSTANTIATE_TEST_SUITE_P(Every, ReactionsBalanceOfRods, testing::ValuesIn([] {
                           std::vector<Kind> out;
                           for (const Kind& kind : kinds)
                             if (!kind.bends && !kind.tackle) out.push_back(kind);
                           return out;
                         }()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Every, MasslessReactionsBalance, testing::ValuesIn(kinds, kinds + massless_kinds),
                         name_of);

/// A net of `side` by `side` rigid or elastic rods with some slack between two anchors.
Scene slack_net(std::uint32_t side, const RodLaw& law) {
  Scene scene;
  const auto number = [side](std::uint32_t row, std::uint32_t column) { return row * side + column; };
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column) {
      const Vec3 at{0.28 * column, -0.28 * row, 0.05 * ((7 * column + 3 * row) % 5)};
      const bool is_held = row == 0 && (column == 0 || column + 1 == side);
      scene.particles.push_back(is_held ? fixed(at) : movable(at, 0.1));
      if (column > 0)
        scene.rods.push_back({.a = number(row, column - 1), .b = number(row, column), .law = law});
      if (row > 0) scene.rods.push_back({.a = number(row - 1, column), .b = number(row, column), .law = law});
    }
  return scene;
}

// Nets solved by lines keep a strain of 1e-11. Of 20 by 20 elastic rods nothing is factorised, and gradient
// old damps what it does not resolve.
TEST(ReactionsOfNets, BalanceWhileTheirAnchorsJerk) {
  for (const Gradient gradient : {Gradient::mid, Gradient::old})
    for (const RodLaw& law : {RodLaw{}, RodLaw{.stiffness = 1e3, .damping = 1}, RodLaw{.stiffness = 1e5}}) {
      const Scene scene = slack_net(law.is_elastic() ? 20 : 14, law);
      Balance balance(scene,
                      {.method = Method::direct, .gradient = gradient, .substeps = 2, .tensions = true},
                      1.0 / 120, true);
      for (int i = 0; i < 30; ++i)
        EXPECT_LT(balance.step(), 1e-10) << to_string(gradient) << law.stiffness << " step " << i;
    }
}

// Velocities of a step are found with its lengths, though a winch has stopped since.
TEST(ReactionsOfRodsWithMass, AreTheSameInARestoredWorld) {
  Scene scene;
  scene.particles = {fixed({}), movable({0.4, -0.3, 0}, 1)};
  scene.rods = {{.a = 0, .b = 1, .mass = 0.05}};
  const Settings settings{.method = Method::direct, .gradient = Gradient::old, .tensions = true};
  World world(scene, settings), other(scene, settings);
  for (int i = 1; i <= 5; ++i) {
    world.set_length(0, 0.5 - 0.01 * i);
    world.step(1.0 / 60);
  }
  other.restore(test::snapshot_of(world));
  world.step(1.0 / 60);
  other.step(1.0 / 60);
  EXPECT_EQ(world.reaction(0), other.reaction(0));
  EXPECT_EQ(world.state_hash(), other.state_hash());
}

// Rods that anchors pull too far apart give way. Such a substep ends near its solution.
TEST(ReactionsOfRodsThatGiveWay, NearlyBalance) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 4; ++i) {
    const Vec3 at{0.3 * i, -0.1 * (i % 2), 0};
    scene.particles.push_back(i % 4 == 0 ? fixed(at) : movable(at, 0.2));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
  }
  World world(scene, {.method = Method::direct, .gradient = Gradient::mid, .tensions = true});
  const auto momentum = [&] {
    return measure_momentum(scene, test::positions_of(world), test::velocities_of(world)).linear;
  };
  constexpr double dt = 1.0 / 120;
  std::uint64_t gave = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 before = momentum();
    world.move_anchor(4, world.position(4) + Vec3{0.004, 0, 0});
    gave += world.step(dt).elastic_substeps;
    const Vec3 off = 1 / dt * (momentum() - before) - sum_of_reactions(world) - Vec3{0, -0.6 * 9.81, 0};
    EXPECT_LT(norm(off), 1e-2 * norm(world.reaction(4))) << i;
  }
  EXPECT_GT(gave, 0u);
}

// A rod to an anchor that is too taut for a substep gets an inertia against turning. What that takes up is in
// the anchor's reaction. A weak spring makes contact's solver move a kilogram that hangs from a light
// particle.
TEST(ReactionsOfSlowedWaves, BalanceMomentum) {
  constexpr double dt = 1.0 / 60;
  for (const double light : {1e-3, 1e-4}) {
    Scene scene;
    scene.particles = {fixed({}), movable({0.4, -0.3, 0}, light), movable({0.8, -0.6, 0}, 1)};
    scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
    scene.springs = {{.a = point_at(0), .b = point_at(2), .length = 1, .stiffness = 1e-3}};
    World world(scene, {.method = Method::direct, .tensions = true});
    const auto momentum = [&] { return light * world.velocity(1) + world.velocity(2); };
    for (int i = 0; i < 300; ++i) {
      const Vec3 before = momentum();
      world.step(dt);
      const Vec3 off = 1 / dt * (momentum() - before) - world.reaction(0) - (1 + light) * scene.gravity;
      // Constraints are solved to 1e-8 of lengths, and rods' pulls are as exact. They were off by 3e-2 N.
      ASSERT_LT(norm(off), 1e-7) << light << ", step " << i;
    }
  }
}

// An anchor's jump is passed on along rods with mass once, in loops as in trees. A loop's own spring is weak.
TEST(LoopsWithMass, FollowAnAnchorThatJumpsAsTreesDo) {
  const auto tip_after = [](bool has_loop) {
    Scene scene;
    for (std::uint32_t i = 0; i <= 3; ++i) {
      const Vec3 at{0.3 * i, -0.03 * i * i, 0};
      scene.particles.push_back(i == 0 ? fixed(at) : movable(at, 0.1));
      if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .mass = 0.5});
    }
    if (has_loop) scene.rods.push_back({.a = 1, .b = 3, .law = {.stiffness = 1e-9}});
    World world(scene,
                {.method = Method::direct, .precision = Precision::double_, .gradient = Gradient::mid});
    for (int i = 1; i <= 12; ++i) {
      world.move_anchor(0, {0, i / 120.0, 0});
      world.step(1.0 / 120);
    }
    return world.position(3);
  };
  // The spring moves the tip by 1e-9 N / 0.3 kg (0.1 s)^2 / 2.
  EXPECT_LT(norm(tip_after(true) - tip_after(false)), 1e-9);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
