// This file measures Bullet's multibody: links on spherical joints, moved by Featherstone's algorithm.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "peer.hpp"

namespace plumb::bench {
namespace {

btVector3 to_bullet(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

class BulletMultibody : public Peer {
 public:
  BulletMultibody(const Model& model, std::uint32_t steps, bool runge_kutta) : steps_(steps) {
    world_.setGravity(to_bullet(model.scene.gravity));
    for (std::size_t begin = 0; begin < model.links.size();) {
      std::size_t end = begin;
      while (end < model.links.size() && model.links[end].root == model.links[begin].root) ++end;
      add_body(model, begin, end, runge_kutta);
      begin = end;
    }
  }

  ~BulletMultibody() override {
    for (const auto& body : bodies_) world_.removeMultiBody(body.get());
  }

  void step_frame() override {
    const btScalar dt = 1.0 / frames_per_second / steps_;
    for (std::uint32_t step = 0; step < steps_; ++step) world_.stepSimulation(dt, 0);
  }

  void copy_state(Frame& frame) override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) copy_body(*bodies_[i], particles_[i], frame);
  }

 private:
  void add_body(const Model& model, std::size_t begin, std::size_t end, bool runge_kutta) {
    auto body =
        std::make_unique<btMultiBody>(static_cast<int>(end - begin), 0, btVector3(0, 0, 0), true, false);
    body->setBasePos(to_bullet(model.scene.particles[model.links[begin].root].position));
    std::vector<std::uint32_t> particles;
    for (std::size_t i = begin; i < end; ++i) {
      const Link& link = model.links[i];
      const btScalar inertia = bead_inertia(link);
      const int parent = link.parent == Link::none ? -1 : link.parent - static_cast<int>(begin);
      // Bullet's origin of a link is its centre of mass, here the particle. The parent's origin is where the
      // joint is.
      body->setupSpherical(static_cast<int>(i - begin), link.mass, btVector3(inertia, inertia, inertia),
                           parent, btQuaternion::getIdentity(), btVector3(0, 0, 0), to_bullet(link.offset),
                           true);
      particles.push_back(link.particle);
    }
    body->finalizeMultiDof();
    body->useRK4Integration(runge_kutta);
    body->setLinearDamping(0);
    body->setAngularDamping(0);
    body->setUseGyroTerm(true);
    // By default joints turn at 100 rad/s at most, and chains whip faster.
    body->setMaxCoordinateVelocity(1e9);
    world_.addMultiBody(body.get());
    bodies_.push_back(std::move(body));
    particles_.push_back(std::move(particles));
  }

  /// Copies positions and velocities from the base outwards. Asking Bullet for one link after the other walks
  /// to the base for each.
  void copy_body(const btMultiBody& body, const std::vector<std::uint32_t>& particles, Frame& frame) {
    const std::size_t links = particles.size();
    angular_.resize(links + 1);
    linear_.resize(links + 1);
    turns_.resize(links);
    body.compTreeLinkVelocities(angular_.data(), linear_.data());
    for (std::size_t k = 0; k < links; ++k) {
      const int link = static_cast<int>(k), parent = body.getParent(link);
      const bool at_base = parent < 0;
      const btQuaternion& turn =
          at_base ? body.getWorldToBaseRot() : turns_[static_cast<std::size_t>(parent)];
      turns_[k] = body.getParentToLocalRot(link) * turn;
      const btQuaternion to_world = turns_[k].inverse();
      const btVector3 from = at_base
                                 ? body.getBasePos()
                                 : to_bullet(frame.positions[particles[static_cast<std::size_t>(parent)]]);
      frame.positions[particles[k]] = from_bullet(from + quatRotate(to_world, body.getRVector(link)));
      frame.velocities[particles[k]] = from_bullet(quatRotate(to_world, linear_[k + 1]));
    }
  }

  std::uint32_t steps_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btMultiBody>> bodies_;
  std::vector<std::vector<std::uint32_t>> particles_;  ///< by body: the particles of its links
  std::vector<btVector3> angular_, linear_;
  std::vector<btQuaternion> turns_;
};

}  // namespace

PeerFamily bullet_multibody_family() {
  PeerFamily family{.name = "Bullet multibody", .must_reach = 1e-4};
  for (const bool runge_kutta : {false, true})
    family.paths.push_back(
        halving_path(runge_kutta ? "Bullet multibody RK4" : "Bullet multibody Euler", "",
                     [runge_kutta](const Model& model, std::uint32_t steps) -> std::unique_ptr<Peer> {
                       return std::make_unique<BulletMultibody>(model, steps, runge_kutta);
                     }));
  return family;
}

}  // namespace plumb::bench
