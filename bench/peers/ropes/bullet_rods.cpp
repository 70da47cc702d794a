// The ropes in Bullet, as capsules on ball joints that its sequential impulses hold together.
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "bullet_ground.hpp"
#include "faller.hpp"

namespace plumb::bench {
namespace {

constexpr int rope_of_ground = -1;

/// Rods of one rope do not touch each other, as in plumb.
struct OtherRopesOnly : btOverlapFilterCallback {
  bool needBroadphaseCollision(btBroadphaseProxy* one, btBroadphaseProxy* other) const override {
    const auto rope_of = [](const btBroadphaseProxy* proxy) {
      return static_cast<const btCollisionObject*>(proxy->m_clientObject)->getUserIndex();
    };
    return rope_of(one) != rope_of(other);
  }
};

class BulletRods : public Faller {
 public:
  BulletRods(const Scene& scene, std::uint32_t steps, int iterations)
      : steps_(steps), ropes_(ropes_of(scene)), ground_(scene) {
    world_.setGravity(to_bullet(scene.gravity));
    world_.getSolverInfo().m_numIterations = iterations;
    world_.getPairCache()->setOverlapFilterCallback(&filter_);
    const Surface& surface = scene.capsules[0].surface;
    half_length_ = 0.5 * rod_length(scene, 0);
    shape_ = std::make_unique<btCapsuleShape>(scene.capsules[0].radius, 2 * half_length_);
    add_ground(surface);
    for (std::uint32_t i = 0; i < ropes_.size(); ++i) add_rope(scene, i, surface);
  }

  ~BulletRods() override {
    for (const auto& each : joints_) world_.removeConstraint(each.get());
    for (const auto& each : bodies_) world_.removeRigidBody(each.get());
    world_.removeRigidBody(ground_body_.get());
  }

  void step() override {
    for (std::uint32_t i = 0; i < steps_; ++i) world_.stepSimulation(frame / steps_, 0);
  }

  void copy_positions(std::span<Vec3> to) const override {
    std::size_t body = 0;
    for (const Rope& rope : ropes_) {
      to[rope.first] = end_of(body, -1);
      for (std::uint32_t k = 1; k < rope.links; ++k)
        to[rope.first + k] = 0.5 * (end_of(body + k - 1, 1) + end_of(body + k, -1));
      to[rope.first + rope.links] = end_of(body + rope.links - 1, 1);
      body += rope.links;
    }
  }

  double strain() const override {
    double most = 0;
    std::size_t body = 0;
    for (const Rope& rope : ropes_) {
      for (std::uint32_t k = 1; k < rope.links; ++k)
        most = std::max(most, norm(end_of(body + k - 1, 1) - end_of(body + k, -1)));
      body += rope.links;
    }
    return most / (2 * half_length_);
  }

  std::uint32_t awake() const override {
    std::uint32_t out = 0;
    std::size_t body = 0;
    for (const Rope& rope : ropes_) {
      bool is_awake = false;
      for (std::uint32_t k = 0; k < rope.links; ++k) is_awake = is_awake || bodies_[body + k]->isActive();
      out += is_awake;
      body += rope.links;
    }
    return out;
  }

 private:
  void add_ground(const Surface& surface) {
    const btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, ground_.shape());
    ground_body_ = std::make_unique<btRigidBody>(info);
    ground_body_->setUserIndex(rope_of_ground);
    ground_body_->setFriction(std::sqrt(surface.friction));
    world_.addRigidBody(ground_body_.get());
  }

  void add_rope(const Scene& scene, std::uint32_t number, const Surface& surface) {
    const Rope& rope = ropes_[number];
    double total = 0;
    for (std::uint32_t k = 0; k <= rope.links; ++k) total += scene.particles[rope.first + k].mass;
    const double mass = total / rope.links;
    btVector3 inertia;
    shape_->calculateLocalInertia(mass, inertia);
    for (std::uint32_t k = 0; k < rope.links; ++k) {
      const btVector3 a = to_bullet(particle_of(scene, rope, k)),
                      b = to_bullet(particle_of(scene, rope, k + 1));
      const btTransform at(shortestArcQuat(btVector3(0, 1, 0), (b - a).normalized()), 0.5 * (a + b));
      auto body = std::make_unique<btRigidBody>(
          btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, shape_.get(), inertia));
      body->setWorldTransform(at);
      body->setUserIndex(static_cast<int>(number));
      // Bullet multiplies the coefficients of both surfaces.
      body->setFriction(std::sqrt(surface.friction));
      body->setDamping(0, 0);
      // As ContactSettings::sleep_speed has it, for ends of rods.
      body->setSleepingThresholds(sleep_speed, sleep_speed / half_length_);
      world_.addRigidBody(body.get());
      if (k > 0) {
        joints_.push_back(std::make_unique<btPoint2PointConstraint>(
            *bodies_.back(), *body, btVector3(0, half_length_, 0), btVector3(0, -half_length_, 0)));
        world_.addConstraint(joints_.back().get(), true);
      }
      bodies_.push_back(std::move(body));
    }
  }

  /// Returns where an end of a rod is, from -1 to 1.
  Vec3 end_of(std::size_t body, double side) const {
    return from_bullet(bodies_[body]->getWorldTransform() * btVector3(0, side * half_length_, 0));
  }

  std::uint32_t steps_;
  std::vector<Rope> ropes_;
  double half_length_ = 0;
  BulletGround ground_;
  OtherRopesOnly filter_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::unique_ptr<btCapsuleShape> shape_;
  std::unique_ptr<btRigidBody> ground_body_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btPoint2PointConstraint>> joints_;
};

}  // namespace

Setting bullet_rods(std::uint32_t steps, int iterations) {
  return {"Bullet rods", std::to_string(steps) + " x " + std::to_string(iterations),
          [=](const Scene& scene) { return std::make_unique<BulletRods>(scene, steps, iterations); }};
}

}  // namespace plumb::bench
