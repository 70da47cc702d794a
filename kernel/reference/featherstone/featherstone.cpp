#include "reference/featherstone/featherstone.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "plumb/layouts/trees.hpp"
#include "reference/featherstone/articulated_body.hpp"
#include "scene/refuse.hpp"
#include "scene/scene_graph.hpp"

namespace plumb::detail {
namespace {

using Eigen::VectorXd;

/// Refuses a loop: names the first rod, in the scene's order, whose ends the rods before it join already.
[[noreturn]] void refuse_loop(const Scene& island, const IslandNames& names) {
  Array<std::uint32_t> above(island.particles.size());
  std::iota(above.begin(), above.end(), 0u);
  const auto root_of = [&](std::uint32_t i) {
    while (above[i] != i) i = above[i] = above[above[i]];
    return i;
  };
  for (std::size_t r = 0; r < island.rods.size(); ++r) {
    const Rod& rod = island.rods[r];
    if (island.particles[rod.a].fixed || island.particles[rod.b].fixed) continue;
    const std::uint32_t a = root_of(rod.a), b = root_of(rod.b);
    if (a == b)
      refuse("rod ", names.rods[r], ": closes a loop (particles ", names.particles[rod.a], " and ",
             names.particles[rod.b],
             " are joined by other rods already), which method featherstone cannot move; use method direct");
    above[a] = b;
  }
  refuse("method featherstone cannot move loops; use method direct");
}

layouts::Tree require_one_way_to_the_ground(const Scene& island, const IslandNames& names) {
  const SceneGraph owner(island);
  std::optional<layouts::Tree> tree = layouts::find_tree(owner.view());
  if (!tree) refuse_loop(island, names);
  if (tree->ties.size() > 1) {
    const layouts::Tree::Tie first = tree->ties[0], second = tree->ties[1];
    const auto [one, other] =
        std::minmax(first, second, [](const auto& a, const auto& b) { return a.edge < b.edge; });
    refuse("rod ", names.rods[other.edge], ": ties to fixed particle ", names.particles[other.vertex],
           " what rod ", names.rods[one.edge], " ties to fixed particle ", names.particles[one.vertex],
           " already, and method featherstone needs one way to the ground; use method direct");
  }
  return *tree;
}

/// Stores the shortest turn from x to the unit vector `to`, as w, x, y, z.
void store_turn(double* q, Vec3 to) {
  const Vec3 x{1, 0, 0};
  if (to.x < -0.5) {  // half a turn about z comes first, so that what is left is far from half a turn
    const Vec3 half{-1, 0, 0};
    const Vec3 axis = cross(half, to);
    const double w = 1 + dot(half, to), over = 1 / std::sqrt(w * w + dot(axis, axis));
    // The product is (w, axis) times (0, 0, 0, 1).
    q[0] = -over * axis.z;
    store3(q + 1, over * Vec3{axis.y, -axis.x, w});
    return;
  }
  const Vec3 axis = cross(x, to);
  const double w = 1 + dot(x, to), over = 1 / std::sqrt(w * w + dot(axis, axis));
  q[0] = over * w;
  store3(q + 1, over * axis);
}

class Featherstone final : public MechanicalSystem {
 public:
  Featherstone(const Scene& island, const Settings& settings, const IslandNames& names)
      : Featherstone(island, settings, require_one_way_to_the_ground(island, names)) {}

  MechanicalState initial_state(const Drive&) const override { return start_; }

  void accelerations(const MechanicalState& state, const Drive& drive, double, VectorXd& out) override {
    BodyLoad load{.gravity = gravity_};
    if (drag_ != 0 && anchor_ != Link::base) load.gravity -= drag_ * drive.anchor_velocities[anchor_];
    if (gather_forces(drive)) load.forces = forces_;
    body_->accelerations(state.q, state.v, load, out);
    if (drag_ != 0) out -= drag_ * state.v;
  }

  void rates(const MechanicalState& state, VectorXd& out) const override {
    body_->rates(state.q, state.v, out);
  }

  void settle(MechanicalState& state, const Drive&, double) override { body_->settle(state.q, state.v); }

  void advance(MechanicalState& state, const Drive& drive, double h) override {
    if (anchor_ != Link::base && !(anchor_velocity_ == drive.anchor_velocities[anchor_])) {
      const Vec3 blow = drive.anchor_velocities[anchor_] - anchor_velocity_;
      body_->accelerations(state.q, rest_, {.base_acceleration = blow}, change_);
      state.v += change_;
      anchor_velocity_ = drive.anchor_velocities[anchor_];
    }
    MechanicalSystem::advance(state, drive, h);
  }

  void place(const MechanicalState& state, const Drive& drive) override {
    const bool hangs = anchor_ != Link::base;
    body_->motions(state.q, state.v, hangs ? drive.anchors[anchor_] : origin_,
                   hangs ? drive.anchor_velocities[anchor_] : Vec3{}, motions_);
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const LinkMotion& motion = motions_[i];
      const Vec3 arm = tips_[i] * motion.rotation.x;
      positions_[particles_[i]] = motion.position + arm;
      velocities_[particles_[i]] = motion.velocity + cross(motion.angular_velocity, arm);
    }
  }
  Vec3 position(const MechanicalState&, std::uint32_t particle) const override {
    return positions_[particle];
  }
  Vec3 velocity(const MechanicalState&, std::uint32_t particle) const override {
    return velocities_[particle];
  }

 private:
  Featherstone(const Scene& island, const Settings& settings, const layouts::Tree& tree)
      : MechanicalSystem(integrator_of(settings)),
        gravity_(island.gravity),
        drag_(island.drag),
        positions_(island.particles.size()),
        velocities_(island.particles.size()) {
    make_body(island, mass_model_of(settings), tree);
    forces_.resize(particles_.size());
    motions_.resize(particles_.size());
    rest_.setZero(body_->speeds());
    change_ = rest_;
    set_start(island, mass_model_of(settings));
  }

  /// Makes the links. Link i moves the tree's node i: its particle and the rod above it.
  void make_body(const Scene& island, MassModel model, const layouts::Tree& tree) {
    Array<Link> links;
    particles_ = tree.vertex;
    for (std::uint32_t i = 0; i < tree.nodes(); ++i) {
      const double own = island.particles[tree.vertex[i]].mass;
      if (i == 0 && tree.ties.empty()) {
        links.push_back({.joint = Joint::translation, .mass = own});
        tips_.push_back(0);
        origin_ = island.particles[tree.vertex[0]].position;
        continue;
      }
      const std::uint32_t r = i == 0 ? tree.ties[0].edge : tree.edge[i];
      if (i == 0) anchor_ = tree.ties[0].vertex;
      const Rod& rod = island.rods[r];
      const double length = rod_length(island, r);
      // The moments of the rod's mass about the joint follow from its mass matrix on its two ends.
      const RodMass mass = rod_mass(island, r, model);
      const double far = rod.b == tree.vertex[i] ? mass.bb : mass.aa;
      const double total = mass.aa + 2 * mass.ab + mass.bb + own;
      const double first = (far + mass.ab + own) * length, second = (far + own) * length * length;
      // A link may have no mass, since all of its particle's may be in the rods that follow.
      const double center = total > 0 ? first / total : 0;
      const double inertia = std::max(0.0, second - first * center);
      links.push_back({.parent = i == 0 ? Link::base : tree.parent[i],
                       .joint = Joint::spherical,
                       .place = {i == 0 ? 0 : tips_[tree.parent[i]], 0, 0},
                       .mass = total,
                       .center = {center, 0, 0},
                       .inertia = {.yy = inertia, .zz = inertia},
                       .grip = {length, 0, 0}});
      tips_.push_back(length);
      joints_.push_back(i == 0 ? anchor_ : tree.vertex[tree.parent[i]]);
    }
    body_.emplace(std::move(links));
  }

  void set_start(const Scene& island, MassModel model) {
    start_.q.setZero(body_->coordinates());
    start_.v.setZero(body_->speeds());
    const std::size_t floating = anchor_ == Link::base ? 1 : 0;  // number of links before the first rod
    for (std::size_t i = floating; i < particles_.size(); ++i) {
      const Vec3 d =
          island.particles[particles_[i]].position - island.particles[joints_[i - floating]].position;
      const double size = norm(d);
      // Two ends at one place have no direction, and any will do.
      store_turn(&start_.q[body_->coordinate(static_cast<std::uint32_t>(i))],
                 size > 0 ? (1 / size) * d : Vec3{0, -1, 0});
    }
    const auto moves = [](const Particle& p) { return !p.fixed && !(p.velocity == Vec3{}); };
    if (std::none_of(island.particles.begin(), island.particles.end(), moves)) return;
    Array<Vec3> momentum(island.particles.size());
    const auto velocity = [&](std::uint32_t i) {
      return island.particles[i].fixed ? Vec3{} : island.particles[i].velocity;
    };
    for (std::uint32_t i = 0; i < island.particles.size(); ++i)
      momentum[i] = island.particles[i].mass * velocity(i);
    for (std::size_t r = 0; r < island.rods.size(); ++r) {
      const Rod& rod = island.rods[r];
      const RodMass mass = rod_mass(island, r, model);
      momentum[rod.a] += mass.aa * velocity(rod.a) + mass.ab * velocity(rod.b);
      momentum[rod.b] += mass.ab * velocity(rod.a) + mass.bb * velocity(rod.b);
    }
    Array<Vec3> impulses;
    for (const std::uint32_t particle : particles_) impulses.push_back(momentum[particle]);
    body_->accelerations(start_.q, rest_, {.forces = impulses}, start_.v);
  }

  /// Gathers the forces by link. Returns false if there are none.
  bool gather_forces(const Drive& drive) {
    bool any = false;
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      forces_[i] = drive.forces[particles_[i]];
      any = any || !(forces_[i] == Vec3{});
    }
    return any;
  }

  Vec3 gravity_;
  double drag_;
  std::optional<ArticulatedBody> body_;
  std::uint32_t anchor_ =
      Link::base;  ///< the island's number of the fixed particle; base if there is none and the island floats
  Vec3 origin_{};  ///< origin of a floating base's coordinates, m
  Vec3 anchor_velocity_{};          ///< the anchor's velocity in the last substep
  Array<std::uint32_t> particles_;  ///< by link's number
  Array<std::uint32_t> joints_;     ///< by rod: the particle at its joint
  Array<double> tips_;              ///< by link: its particle's distance from its joint, m
  MechanicalState start_;
  Array<Vec3> forces_;
  Array<LinkMotion> motions_;
  Array<Vec3> positions_, velocities_;  ///< by the island's particle, as last placed
  VectorXd rest_, change_;              ///< zero speeds; what a blow of the anchor makes of them
};

}  // namespace

std::unique_ptr<MechanicalSystem> make_featherstone(const Scene& island, const Settings& settings,
                                                    const IslandNames& names) {
  return std::make_unique<Featherstone>(island, settings, names);
}

}  // namespace plumb::detail
