// This file measures Bullet's soft body: particles and links, positions corrected link by link (PBD).
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
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

class BulletSoft : public Peer {
 public:
  BulletSoft(const Model& model, std::uint32_t steps, int iterations) : steps_(steps) {
    const btVector3 gravity = to_bullet(model.scene.gravity);
    world_.setGravity(gravity);
    btSoftBodyWorldInfo& info = world_.getWorldInfo();
    info.m_gravity = gravity;
    info.air_density = 0;
    info.water_density = 0;
    // Each thing that hangs is one body, as a user would have it.
    for (std::size_t begin = 0; begin < model.links.size();) {
      std::size_t end = begin;
      while (end < model.links.size() && model.links[end].root == model.links[begin].root) ++end;
      add_body(model, begin, end, iterations);
      begin = end;
    }
  }

  ~BulletSoft() override {
    for (const auto& body : bodies_) world_.removeSoftBody(body.get());
  }

  void step_frame() override {
    const btScalar dt = 1.0 / frames_per_second / steps_;
    for (std::uint32_t step = 0; step < steps_; ++step) world_.stepSimulation(dt, 0);
  }

  void copy_state(Frame& frame) override {
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for (std::size_t k = 1; k < particles_[i].size(); ++k) {
        const btSoftBody::Node& node = bodies_[i]->m_nodes[static_cast<int>(k)];
        frame.positions[particles_[i][k]] = from_bullet(node.m_x);
        frame.velocities[particles_[i][k]] = from_bullet(node.m_v);
      }
  }

 private:
  void add_body(const Model& model, std::size_t begin, std::size_t end, int iterations) {
    auto body = std::make_unique<btSoftBody>(&world_.getWorldInfo());
    // The material comes before the nodes, which refer to it.
    btSoftBody::Material* material = body->appendMaterial();
    material->m_kLST = 1;
    std::vector<std::uint32_t> particles;
    const auto add = [&](std::uint32_t particle, double mass) {
      body->appendNode(to_bullet(model.scene.particles[particle].position), mass);
      particles.push_back(particle);
    };
    add(model.links[begin].root, 0);
    // Links go from the fixed end outwards, which corrects a chain better than other orders.
    for (std::size_t i = begin; i < end; ++i) {
      const Link& link = model.links[i];
      add(link.particle, link.mass);
      const int parent = link.parent == Link::none ? 0 : link.parent - static_cast<int>(begin) + 1;
      body->appendLink(parent, static_cast<int>(i - begin) + 1, material);
    }
    body->m_cfg.kDP = 0;
    body->m_cfg.piterations = iterations;
    body->m_cfg.viterations = 0;
    body->m_cfg.collisions = 0;
    body->setActivationState(DISABLE_DEACTIVATION);
    world_.addSoftBody(body.get());
    bodies_.push_back(std::move(body));
    particles_.push_back(std::move(particles));
  }

  std::uint32_t steps_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btSoftBody>> bodies_;
  std::vector<std::vector<std::uint32_t>> particles_;  ///< by body: the particles of its nodes
};

}  // namespace

PeerFamily bullet_soft_family() {
  // Each step damps, so that the error is of first order.
  PeerFamily family{.name = "Bullet soft", .must_reach = 2e-2};
  for (const int iterations : {1, 4, 16, 64})
    family.paths.push_back(
        halving_path("Bullet soft", "x" + std::to_string(iterations),
                     [iterations](const Model& model, std::uint32_t steps) -> std::unique_ptr<Peer> {
                       return std::make_unique<BulletSoft>(model, steps, iterations);
                     }));
  return family;
}

}  // namespace plumb::bench
