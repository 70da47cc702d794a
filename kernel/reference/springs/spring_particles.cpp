// This file models a rope of particles and springs (thesis figure 3.13 and eq. 3.11). Masses are lumped, and
// every rod is a spring of its length, damped along itself.
#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/springs/springs.hpp"

namespace plumb::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

class SpringParticles final : public SpringSystem {
 public:
  SpringParticles(const Scene& island, const Settings& settings)
      : SpringSystem(island, settings), body_(island.particles.size(), no_body) {
    const std::vector<double> masses = lumped_masses(island);
    for (std::uint32_t i = 0; i < body_.size(); ++i) {
      if (island.particles[i].fixed) continue;
      body_[i] = static_cast<std::uint32_t>(particles_.size());
      particles_.push_back(i);
    }
    masses_.resize(3 * static_cast<Eigen::Index>(particles_.size()));
    for (std::size_t i = 0; i < particles_.size(); ++i)
      masses_.segment<3>(3 * static_cast<Eigen::Index>(i)).setConstant(masses[particles_[i]]);
    for (std::size_t r = 0; r < island.rods.size(); ++r) {
      Spring spring{island.rods[r].a, island.rods[r].b, rod_length(island, r), 0};
      if (body_[spring.a] == no_body) std::swap(spring.a, spring.b);
      spring.damping = spring_damping(settings.springs, masses[spring.a], masses[spring.b]);
      springs_.push_back(spring);
    }
  }

  MechanicalState initial_state(const Drive&) const override {
    MechanicalState state{VectorXd(masses_.size()), VectorXd(masses_.size())};
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const Particle& particle = scene().particles[particles_[i]];
      state.q.segment<3>(3 * static_cast<Eigen::Index>(i)) = to_eigen(particle.position);
      state.v.segment<3>(3 * static_cast<Eigen::Index>(i)) = to_eigen(particle.velocity);
    }
    return state;
  }

  Eigen::Index body_size() const override { return 3; }

  void find_forces(const MechanicalState& state, const Drive& drive, double t, VectorXd& out) override {
    const Vector3d gravity = to_eigen(scene().gravity);
    out.resize(masses_.size());
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const auto row = 3 * static_cast<Eigen::Index>(i);
      out.segment<3>(row) = masses_[row] * (gravity - scene().drag * state.v.segment<3>(row)) +
                            to_eigen(drive.forces[particles_[i]]);
    }
    for (const Spring& spring : springs_) {
      const Reach reach = reach_of(spring, state, drive, t);
      const double pull = settings().springs.stiffness * (reach.length - spring.length) +
                          spring.damping * reach.along.dot(reach.velocity);
      out.segment<3>(3 * body_[spring.a]) += pull * reach.along;
      if (body_[spring.b] != no_body) out.segment<3>(3 * body_[spring.b]) -= pull * reach.along;
    }
  }

  void linearize(const MechanicalState& state, const Drive& drive, double t, Linearization& out) override {
    out.springs.resize(springs_.size());
    out.turning.resize(0);
    for (std::size_t i = 0; i < springs_.size(); ++i) {
      const Spring& spring = springs_[i];
      const Reach reach = reach_of(spring, state, drive, t);
      const Matrix3d along = reach.along * reach.along.transpose();
      const double k = settings().springs.stiffness;
      // A stretched spring also holds its ends sideways; a compressed one pushes them away.
      const double sideways = reach.length > spring.length ? k * (1 - spring.length / reach.length) : 0;
      out.springs[i].a = body_[spring.a];
      out.springs[i].b = body_[spring.b];
      out.springs[i].stiffness = (k - sideways) * along + sideways * Matrix3d::Identity();
      out.springs[i].damping = spring.damping * along;
    }
  }

  double energy(const MechanicalState& state, const Drive& drive) const override {
    double sum = 0.5 * state.v.cwiseAbs2().dot(masses_);
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const auto row = 3 * static_cast<Eigen::Index>(i);
      sum -= masses_[row] * to_eigen(scene().gravity).dot(state.q.segment<3>(row));
    }
    for (const Spring& spring : springs_) {
      const double extension = reach_of(spring, state, drive, 0).length - spring.length;
      sum += 0.5 * settings().springs.stiffness * extension * extension;
    }
    return sum;
  }

  Vec3 position(const MechanicalState& state, std::uint32_t particle) const override {
    return to_vec3(state.q.segment<3>(3 * body_[particle]));
  }
  Vec3 velocity(const MechanicalState& state, std::uint32_t particle) const override {
    return to_vec3(state.v.segment<3>(3 * body_[particle]));
  }

 private:
  struct Spring {
    std::uint32_t a = 0, b = 0;  ///< Numbers of its particles; a is movable.
    double length = 0;           ///< Rest length, in m.
    double damping = 0;          ///< Damping along itself, in N s/m.
  };
  /// Says how a spring stands and moves, from a to b.
  struct Reach {
    double length = 0;
    Vector3d along{0, 0, 0};     ///< Unit vector; zero if the ends coincide.
    Vector3d velocity{0, 0, 0};  ///< Velocity of b relative to a, in m/s.
  };
  Reach reach_of(const Spring& spring, const MechanicalState& state, const Drive& drive, double t) const {
    Vector3d end, velocity;
    if (body_[spring.b] == no_body) {
      end = to_eigen(drive.anchor(spring.b, t));
      velocity = to_eigen(drive.anchor_velocities[spring.b]);
    } else {
      end = state.q.segment<3>(3 * body_[spring.b]);
      velocity = state.v.segment<3>(3 * body_[spring.b]);
    }
    Reach reach;
    const Vector3d d = end - state.q.segment<3>(3 * body_[spring.a]);
    reach.length = d.norm();
    if (reach.length > 0) reach.along = d / reach.length;
    reach.velocity = velocity - state.v.segment<3>(3 * body_[spring.a]);
    return reach;
  }

  Array<std::uint32_t> body_;       ///< Body of every particle.
  Array<std::uint32_t> particles_;  ///< Particle of every body.
  Array<Spring> springs_;
};

}  // namespace

std::unique_ptr<SpringSystem> make_spring_particles(const Scene& island, const Settings& settings) {
  return std::make_unique<SpringParticles>(island, settings);
}

}  // namespace plumb::detail
