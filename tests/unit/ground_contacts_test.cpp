// Contacts that stand in an island's matrix, on a ball whose answer is known.

#include "contact/ground/ground_contacts.hpp"

#include <gtest/gtest.h>

#include <array>

#include "plumb/joints.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr double mass = 2, friction = 0.5;

/// A ball that falls on ground along z, and how Newton's method solves for its motion.
class Ball {
 public:
  Ball() : linkage_(scene(), best_isa()), state_(linkage_, 0, scene()) {
    Combination at;
    at.add(0, 1);
    ground_.add({.at = at, .normal = {0, 0, 1}, .gap = 0.01, .friction = friction}, linkage_.heaviest(at));
  }

  /// Returns where a push takes it, at rest and free otherwise, in m. `steps` says in how many of Newton's.
  Vec3 moved_by(Vec3 push, int& steps) {
    Array<simd::Quad> unknowns(linkage_.plan().columns());
    Vec3 moved = (1 / mass) * push;
    ground_.begin_positions(false, false);
    for (steps = 0; steps < 20; ++steps) {
      ground_.look(linkage_, std::array{moved}, true);
      if (steps > 0 && ground_.lack() <= 1e-9) break;
      state_.assemble_with_elastics(state_.x, [](std::size_t) { return -1.0; });
      EXPECT_TRUE(ground_.factor(state_));
      unknowns.assign(unknowns.size(), simd::Quad{});
      linkage_.add(Combination{{{{0, 1}}}, 1}, push, numbers(unknowns));
      ground_.add_pushes(linkage_, std::array{moved}, numbers(unknowns));
      linkage_.plan().solve(state_.factors, unknowns);
      moved = linkage_.taken(numbers(unknowns), 0);
      ground_.follow_solution(std::array{moved});
    }
    return moved;
  }
  GroundContacts& ground() { return ground_; }

 private:
  static Scene scene() {
    Scene out;
    out.particles.push_back({.mass = mass});
    out.capsules.push_back({.a = point_at(0), .b = point_at(0), .radius = 0.1});
    return out;
  }

  Linkage linkage_;
  LinkageState state_;
  GroundContacts ground_;
};

// Stiffness and grip are 1e4 and 1e3 of the mass: what is held moves by no more than those shares of what the
// push would do.
TEST(GroundContacts, HoldWhatPressesAndSticks) {
  Ball ball;
  int steps = 0;
  const Vec3 free{0.001, 0, -0.1};
  const Vec3 moved = ball.moved_by(mass * free, steps);
  EXPECT_NEAR(moved.z, -0.01, 1e-4 * 0.1);
  EXPECT_NEAR(moved.x, 0, 1e-3 * 0.001 + 1e-15);
  EXPECT_EQ(ball.ground().count_pushes(), 1u);
  EXPECT_LE(steps, 8);
}

TEST(GroundContacts, LetSlideWhatIsBeyondTheCone) {
  Ball ball;
  int steps = 0;
  const Vec3 moved = ball.moved_by(mass * Vec3{0.2, 0, -0.1}, steps);
  // The ground takes mu times the normal push of 0.09 of the mass.
  EXPECT_NEAR(moved.x, 0.2 - friction * 0.09, 1e-4 * 0.1);
  EXPECT_LE(steps, 10);
}

TEST(GroundContacts, LeaveAloneWhatDoesNotArrive) {
  Ball ball;
  int steps = 0;
  const Vec3 free{0.2, 0, -0.009};
  EXPECT_EQ(ball.moved_by(mass * free, steps), free);
  EXPECT_EQ(ball.ground().count_pushes(), 0u);
}

// A contact that did not push on positions does not push on velocities.
TEST(GroundContacts, PushOnVelocitiesWherePositionsWerePushed) {
  Ball ball;
  int steps = 0;
  ball.moved_by(mass * Vec3{0, 0, -0.1}, steps);
  ball.ground().begin_velocities();
  ball.ground().for_kept([](const GroundContact& contact, Vec3 position, Vec3) {
    EXPECT_NEAR(position.z, 0.09 * mass, 1e-4 * mass);
    EXPECT_EQ(contact.friction, friction);
  });
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
