// Contacts of bodies that relaxation pushes as a whole.

#include "contact/relaxed/bodies/rigid_contacts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "contact/relaxed/bodies/rigid_frame.hpp"
#include "contact/relaxed/places/middle.hpp"
#include "plumb/joints.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using Rigid = RigidContacts<double>;

/// A box of 2 kg without weight, and a contact that pushes its corner up.
class Corner {
 public:
  explicit Corner(Vec3 velocity)
      : kind_(scene(velocity), best_isa(), Linkage::Use::relaxed),
        state_(kind_, 0, scene(velocity)),
        cluster_{&state_} {
    crowd_.gather(cluster_, {});
    crowd_.predict(h, Gradient::old);
    place_ = combination(point_on_body(scene({}), 0, {0.2, -0.1, 0.3}));
    particles_ = kind_.bodies().front().particles;
    middle_.emplace(crowd_, kind_, 0, place_);
    number_ = rigid_.add(crowd_, {Rigid::Side{0, &particles_, middle_->terms()}, Rigid::Side{}}, {0, 1, 0});
  }

  void visit(double gap, double friction, int times) {
    const std::span<const Rigid::Term> terms = middle_->terms();
    for (int i = 0; i < times; ++i)
      rigid_.visit(crowd_, {number_, terms, terms.size(), {0, 1, 0}, {}, gap, friction}, push, across);
  }
  void begin_rigidly() { rigid_.begin_rigidly(crowd_); }
  Vec3 moved() const { return crowd_.moved(middle_->terms()); }
  RigidFrame frame() const { return *rigid_frame(crowd_, 0, particles_); }
  Vec3 momentum() const {
    Vec3 sum{};
    for (const std::uint32_t particle : particles_)
      sum += 1 / crowd_.inverse_mass(0, particle) * crowd_.moved(crowd_.number_of(0, particle));
    return sum;
  }
  /// By how much displacements change distances of its particles, in m.
  double stretch() const {
    double most = 0;
    for (const std::uint32_t a : particles_)
      for (const std::uint32_t b : particles_) {
        if (a == b) continue;
        const std::uint32_t i = crowd_.number_of(0, a), k = crowd_.number_of(0, b);
        const Vec3 apart = crowd_.position(i) - crowd_.position(k);
        most = std::max(most, std::abs(dot(apart, crowd_.moved(i) - crowd_.moved(k))) / norm(apart));
      }
    return most;
  }

  static constexpr double h = 0.01;
  double push = 0;
  Vec3 across{};

 private:
  static Scene scene(Vec3 velocity) {
    Scene out;
    out.gravity = {};
    add_body(out, solid_box(2, {0.4, 0.2, 0.6}));
    out.particles.front().velocity = velocity;
    return out;
  }

  Linkage kind_;
  LinkageState state_;
  std::vector<LinkageState*> cluster_;
  Crowd<double> crowd_;
  Combination place_;
  std::array<std::uint32_t, 4> particles_{};
  std::optional<Middle<double>> middle_;
  Rigid rigid_;
  std::uint32_t number_ = 0;
};

// A box of 40 x 20 x 60 cm has m/12 (h² + d²) about x, and so on.
TEST(RigidFrame, HasTheInertiaOfTheBody) {
  const RigidFrame frame = Corner({}).frame();
  const double x = 2.0 / 12 * (0.04 + 0.36), y = 2.0 / 12 * (0.16 + 0.36), z = 2.0 / 12 * (0.16 + 0.04);
  EXPECT_NEAR(frame.inverse_mass, 0.5, 1e-15);
  EXPECT_NEAR(frame.determinant, x * y * z, 1e-15);
  EXPECT_NEAR(norm(frame.adjugate[0] - Vec3{y * z, 0, 0}), 0, 1e-15);
  EXPECT_NEAR(norm(frame.adjugate[1] - Vec3{0, x * z, 0}), 0, 1e-15);
  Vec3 sum{};
  for (std::size_t i = 0; i < 4; ++i) sum += frame.mass[i] * frame.offsets[i];
  EXPECT_NEAR(norm(sum), 0, 1e-15);
}

// A visit ends the overlap at once where nothing resists sliding, and moves the body as a whole.
TEST(RigidContacts, PushTheWholeBody) {
  Corner corner({});
  corner.visit(-0.01, 0, 1);
  EXPECT_NEAR(corner.moved().y, 0.01, 1e-14);
  EXPECT_NEAR(norm(corner.momentum() - Vec3{0, corner.push, 0}), 0, 1e-14);
  EXPECT_LT(corner.stretch(), 1e-14);
}

// What sticks ends where it was but for the overlap. What slides is held by Coulomb's bound, against the
// motion.
TEST(RigidContacts, StickAndSlide) {
  Corner sticks({});
  sticks.visit(-0.01, 10, 200);
  EXPECT_NEAR(norm(sticks.moved() - Vec3{0, 0.01, 0}), 0, 1e-12);
  EXPECT_NEAR(norm(sticks.momentum() - Vec3{0, sticks.push, 0} - sticks.across), 0, 1e-13);
  Corner slides({});
  slides.visit(-0.01, 0.05, 200);
  EXPECT_NEAR(norm(slides.across), 0.05 * slides.push, 1e-14);
  const Vec3 slid = slides.moved() - Vec3{0, slides.moved().y, 0};
  EXPECT_NEAR(dot(slid, slides.across), -norm(slid) * norm(slides.across), 1e-12 * norm(slid));
}

TEST(RigidContacts, LetGoWhatDoesNotArrive) {
  Corner corner({});
  corner.visit(0.01, 1, 3);
  EXPECT_EQ(corner.push, 0);
  EXPECT_EQ(corner.moved(), Vec3{});
}

// The motion of one particle becomes that of a rigid body, with its momentum.
TEST(RigidContacts, BeginRigidly) {
  Corner corner({1, 2, 3});
  const Vec3 before = corner.momentum();
  EXPECT_GT(corner.stretch(), 1e-3);
  corner.begin_rigidly();
  EXPECT_LT(corner.stretch(), 1e-15);
  EXPECT_NEAR(norm(corner.momentum() - before), 0, 1e-15);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
