#include <algorithm>
#include <optional>

#include "reference/featherstone/articulated_body.hpp"
#include "reference/featherstone/body_tree.hpp"
#include "reference/featherstone/featherstone.hpp"
#include "reference/featherstone/turning.hpp"
#include "reference/multipliers/joint_forces.hpp"

namespace plumb::detail {
namespace {

using Eigen::VectorXd;

/// Bodies are links, whose frames start turned as space. A body that floats has a translation without mass
/// above it.
class JointedFeatherstone final : public MechanicalSystem {
 public:
  JointedFeatherstone(const Scene& island, const Settings& settings, std::uint32_t particle)
      : MechanicalSystem(integrator_of(settings)),
        tree_(find_body_tree(island, particle)),
        gravity_(island.gravity),
        drag_(island.drag),
        movable_(static_cast<std::uint32_t>(std::count_if(island.particles.begin(), island.particles.end(),
                                                          [](const Particle& each) { return !each.fixed; }))),
        pulls_(!island.springs.empty() || !island.torsions.empty() || !island.angles.empty()),
        joint_forces_(island, movable_) {
    for (const Particle& each : island.particles) x_.push_back(each.position);
    v_.resize(x_.size());
    pull_.setZero(3 * Eigen::Index(movable_));
    make_links(island);
    set_start(island);
  }

  MechanicalState initial_state(const Drive&) const override { return start_; }

  void accelerations(const MechanicalState& state, const Drive& drive, double t, VectorXd& out) override {
    BodyLoad load{.gravity = gravity_};
    if (drag_ != 0) load.gravity -= drag_ * ground(drive.anchor_velocities);
    pull_.setZero();
    for (std::uint32_t i = 0; i < movable_; ++i) store3(&pull_[3 * i], drive.forces[i]);
    if (pulls_ || !pull_.isZero(0)) {
      put(state, drive, t);
      joint_forces_.add(x_, v_, pull_);
      gather();
      load.forces = forces_;
      load.moments = moments_;
    }
    body_->accelerations(state.q, state.v, load, out);
    if (drag_ != 0) out -= drag_ * state.v;
  }

  void rates(const MechanicalState& state, VectorXd& out) const override {
    body_->rates(state.q, state.v, out);
  }

  void settle(MechanicalState& state, const Drive& drive, double t) override {
    body_->settle(state.q, state.v);
    if (!pulls_) return;
    put(state, drive, t);
    joint_forces_.follow(x_);
  }

  void advance(MechanicalState& state, const Drive& drive, double h) override {
    const Vec3 now = ground(drive.anchor_velocities);
    if (!(now == ground_velocity_)) {
      body_->accelerations(state.q, rest_, {.base_acceleration = now - ground_velocity_}, change_);
      state.v += change_;
      ground_velocity_ = now;
    }
    MechanicalSystem::advance(state, drive, h);
  }

  void place(const MechanicalState& state, const Drive& drive) override { put(state, drive, 0); }
  Vec3 position(const MechanicalState&, std::uint32_t particle) const override { return x_[particle]; }
  Vec3 velocity(const MechanicalState&, std::uint32_t particle) const override { return v_[particle]; }

 private:
  /// Returns the part that the place from which all hangs takes of vectors of fixed particles.
  Vec3 ground(const Array<Vec3>& of) const {
    Vec3 sum{};
    for (std::size_t i = 0; tree_.hangs && i < 4; ++i)
      if (tree_.ground.weights[i] != 0) sum += tree_.ground.weights[i] * of[tree_.ground.particles[i]];
    return sum;
  }

  void make_links(const Scene& island) {
    const Vec3 base = ground(x_);
    Array<Link> links;
    Array<std::uint32_t> link_of(island.bodies.size());
    for (const BodyTree::Hung& hung : tree_.hung) {
      Link link = weighed(island, hung);
      const bool on_body = hung.parent != BodyTree::none;
      link.parent = on_body ? link_of[tree_.hung[hung.parent].body] : Link::base;
      link.place = hung.joint - (on_body ? tree_.hung[hung.parent].joint : base);
      if (hung.floats) {
        links.push_back({.joint = Joint::translation, .place = link.place});
        link.parent = static_cast<std::uint32_t>(links.size() - 1);
        link.place = {};
      }
      link.joint = hung.is_hinge ? Joint::revolute : Joint::spherical;
      if (hung.is_hinge) link.axis = hung.axis;
      link_of[hung.body] = static_cast<std::uint32_t>(links.size());
      links.push_back(link);
    }
    Array<Vec3> joint_of(island.bodies.size());
    for (const BodyTree::Hung& hung : tree_.hung) joint_of[hung.body] = hung.joint;
    for (std::uint32_t i = 0; i < movable_; ++i) {
      const std::uint32_t body = tree_.owner[i];
      carried_.push_back({link_of[body], x_[i] - joint_of[body]});
    }
    body_.emplace(std::move(links));
    motions_.resize(body_->links());
    forces_.resize(body_->links());
    moments_.resize(body_->links());
    rest_.setZero(body_->speeds());
    change_ = rest_;
  }

  /// Returns a link with the mass of a body and of the particles that it owns.
  Link weighed(const Scene& island, const BodyTree::Hung& hung) const {
    const Body& body = island.bodies[hung.body];
    struct Part {
      double mass;
      Vec3 at;
    };
    Array<Part> parts{{body.mass, body.center}};
    for (std::uint32_t i = 0; i < movable_; ++i)
      if (tree_.owner[i] == hung.body && island.particles[i].mass > 0)
        parts.push_back({island.particles[i].mass, x_[i]});
    Link link;
    Vec3 first{};
    for (const Part& part : parts) {
      link.mass += part.mass;
      first += part.mass * part.at;
    }
    const Vec3 center = (1 / link.mass) * first;
    Sym3 own = tensor(body.inertia);
    for (const Part& part : parts) own += point_inertia(part.mass, part.at - center);
    link.center = center - hung.joint;
    link.inertia = {.xx = own.xx, .yy = own.yy, .zz = own.zz, .xy = own.xy, .xz = own.xz, .yz = own.yz};
    return link;
  }

  void set_start(const Scene& island) {
    start_.q.setZero(body_->coordinates());
    start_.v.setZero(body_->speeds());
    for (std::uint32_t i = 0; i < body_->links(); ++i)
      if (body_->is_spherical(i)) start_.q[body_->coordinate(i)] = 1;
    // The velocities closest to given ones, by mass, are what impulses M v bring about from rest.
    const auto velocity = [&](std::uint32_t i) {
      return island.particles[i].fixed ? Vec3{} : island.particles[i].velocity;
    };
    const auto add = [&](std::uint32_t i, Vec3 impulse) {
      if (i < movable_) store3(&pull_[3 * i], load3(&pull_[3 * i]) + impulse);
    };
    for (std::uint32_t i = 0; i < movable_; ++i) add(i, island.particles[i].mass * velocity(i));
    for (std::size_t b = 0; b < island.bodies.size(); ++b) {
      const auto mass = body_mass(island, b);
      const auto& of = island.bodies[b].particles;
      for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t k = 0; k < 4; ++k) add(of[j], mass[j][k] * velocity(of[k]));
    }
    if (pull_.isZero(0)) return;
    Drive rest{{}, x_, Array<Vec3>(x_.size())};
    put(start_, rest, 0);
    gather();
    body_->accelerations(start_.q, rest_, {.forces = forces_, .moments = moments_}, start_.v);
  }

  /// Finds where all particles are, and how they move.
  void put(const MechanicalState& state, const Drive& drive, double t) {
    body_->motions(state.q, state.v, ground(drive.anchors) + t * ground(drive.anchor_velocities),
                   ground(drive.anchor_velocities), motions_);
    for (std::uint32_t i = 0; i < movable_; ++i) {
      const LinkMotion& motion = motions_[carried_[i].link];
      const Vec3 arm = motion.rotation * carried_[i].arm;
      x_[i] = motion.position + arm;
      v_[i] = motion.velocity + cross(motion.angular_velocity, arm);
    }
    for (std::uint32_t i = movable_; i < x_.size(); ++i) {
      x_[i] = drive.anchor(i, t);
      v_[i] = drive.anchor_velocities[i];
    }
  }

  /// Adds up what pulls on particles by the links that carry them.
  void gather() {
    std::fill(forces_.begin(), forces_.end(), Vec3{});
    std::fill(moments_.begin(), moments_.end(), Vec3{});
    for (std::uint32_t i = 0; i < movable_; ++i) {
      const Vec3 force = load3(&pull_[3 * i]);
      const std::uint32_t link = carried_[i].link;
      forces_[link] += force;
      moments_[link] += cross(x_[i] - motions_[link].position, force);
    }
  }

  struct Carried {
    std::uint32_t link;
    Vec3 arm;  ///< in the link's frame, m
  };

  BodyTree tree_;
  Vec3 gravity_;
  double drag_;
  std::uint32_t movable_;
  bool pulls_;
  JointForces joint_forces_;
  std::optional<ArticulatedBody> body_;
  Vec3 ground_velocity_{};  ///< in the last substep
  MechanicalState start_;
  Array<Carried> carried_;  ///< by movable particle
  Array<LinkMotion> motions_;
  Array<Vec3> forces_, moments_;  ///< by link
  Array<Vec3> x_, v_;             ///< by particle, as last put
  VectorXd pull_;                 ///< N, by movable particle
  VectorXd rest_, change_;        ///< zero speeds; what a blow of the ground makes of them
};

}  // namespace

std::unique_ptr<MechanicalSystem> make_jointed_featherstone(const Scene& island, const Settings& settings,
                                                            std::uint32_t particle) {
  return std::make_unique<JointedFeatherstone>(island, settings, particle);
}

}  // namespace plumb::detail
