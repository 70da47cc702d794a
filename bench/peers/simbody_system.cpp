#include "simbody_system.hpp"

#include <Simbody.h>

namespace plumb::bench {
namespace {

SimTK::Vec3 to_simbody(const Triple& v) {
  return {v[0], v[1], v[2]};
}
Triple from_simbody(const SimTK::Vec3& v) {
  return {v[0], v[1], v[2]};
}

std::unique_ptr<SimTK::Integrator> make_integrator(const SimTK::System& system, SimbodyMethod method,
                                                   double step) {
  switch (method) {
    case SimbodyMethod::semi_explicit_euler:
      return std::make_unique<SimTK::SemiExplicitEulerIntegrator>(system, step);
    case SimbodyMethod::semi_explicit_euler_2:
      return std::make_unique<SimTK::SemiExplicitEuler2Integrator>(system);
    case SimbodyMethod::verlet:
      return std::make_unique<SimTK::VerletIntegrator>(system);
    case SimbodyMethod::runge_kutta_3:
      return std::make_unique<SimTK::RungeKutta3Integrator>(system);
    case SimbodyMethod::runge_kutta_merson:
      break;
  }
  return std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system);
}

}  // namespace

struct SimbodySystem::Parts {
  SimTK::MultibodySystem system{};
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  std::vector<SimTK::MobilizedBodyIndex> bodies{};
  std::unique_ptr<SimTK::Integrator> integrator{};
};

SimbodySystem::SimbodySystem(const std::vector<SimbodyLink>& links, const Triple& gravity,
                             const SimbodyPlan& plan)
    : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  for (const SimbodyLink& link : links) {
    SimTK::MobilizedBody& parent =
        link.parent < 0 ? static_cast<SimTK::MobilizedBody&>(p.matter.updGround())
                        : p.matter.updMobilizedBody(p.bodies[static_cast<std::size_t>(link.parent)]);
    const SimTK::Body::Rigid body(
        SimTK::MassProperties(link.mass, SimTK::Vec3(0), SimTK::Inertia(link.inertia)));
    const SimTK::MobilizedBody::Ball ball(parent, SimTK::Transform(to_simbody(link.joint)), body,
                                          SimTK::Transform(-to_simbody(link.offset)));
    p.bodies.push_back(ball.getMobilizedBodyIndex());
  }
  const SimTK::Force::UniformGravity force(p.forces, p.matter, to_simbody(gravity));
  const SimTK::State start = p.system.realizeTopology();
  p.integrator = make_integrator(p.system, plan.method, plan.step);
  if (plan.method != SimbodyMethod::semi_explicit_euler) p.integrator->setAccuracy(plan.accuracy);
  p.integrator->setFinalTime(plan.duration);
  p.integrator->initialize(start);
}

SimbodySystem::~SimbodySystem() = default;

void SimbodySystem::step_to(double time) {
  SimTK::Integrator& integrator = *parts_->integrator;
  while (integrator.getTime() < time && !integrator.isSimulationOver()) integrator.stepTo(time);
}

void SimbodySystem::copy_state(std::vector<Triple>& positions, std::vector<Triple>& velocities) const {
  const SimTK::State& state = parts_->integrator->getState();
  parts_->system.realize(state, SimTK::Stage::Velocity);
  positions.clear();
  velocities.clear();
  for (const SimTK::MobilizedBodyIndex index : parts_->bodies) {
    const SimTK::MobilizedBody& body = parts_->matter.getMobilizedBody(index);
    positions.push_back(from_simbody(body.getBodyOriginLocation(state)));
    velocities.push_back(from_simbody(body.getBodyOriginVelocity(state)));
  }
}

}  // namespace plumb::bench
