// This file measures Simbody: mobilized bodies on ball joints, in linear time, by steps of fixed or of chosen
// length.
#include <cmath>

#include "peer.hpp"
#include "scenes/basics/numbers.hpp"
#include "simbody_system.hpp"

namespace plumb::bench {
namespace {

Triple to_triple(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Vec3 to_vec3(const Triple& v) {
  return {v[0], v[1], v[2]};
}

std::vector<SimbodyLink> simbody_links(const Model& model) {
  std::vector<SimbodyLink> out;
  for (const Link& link : model.links)
    out.push_back(
        {.parent = link.parent,
         .joint = link.parent == Link::none ? to_triple(model.scene.particles[link.root].position) : Triple{},
         .offset = to_triple(link.offset),
         .mass = link.mass,
         .inertia = bead_inertia(link)});
  return out;
}

class Simbody : public Peer {
 public:
  Simbody(const Model& model, const SimbodyPlan& plan)
      : links_(model.links),
        duration_(plan.duration),
        system_(simbody_links(model), to_triple(model.scene.gravity), plan) {}

  void step_frame() override {
    ++frame_;
    // The last time is taken without the rounding of the division, or its state would be interpolated.
    const double time = static_cast<double>(frame_) / frames_per_second;
    system_.step_to(std::abs(time - duration_) < 1e-9 ? duration_ : time);
  }

  void copy_state(Frame& frame) override {
    system_.copy_state(positions_, velocities_);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      frame.positions[links_[i].particle] = to_vec3(positions_[i]);
      frame.velocities[links_[i].particle] = to_vec3(velocities_[i]);
    }
  }

 private:
  const std::vector<Link>& links_;
  double duration_;
  SimbodySystem system_;
  long frame_ = 0;
  std::vector<Triple> positions_, velocities_;
};

/// Makes a path of steps that Simbody chooses to an accuracy, from 1/2 on by quarters.
PeerPath accuracy_path(const std::string& label, SimbodyMethod method) {
  const auto accuracy = [](std::uint32_t level) { return std::ldexp(0.5, -2 * static_cast<int>(level)); };
  return {.levels = 20,
          .name =
              [=](std::uint32_t level) {
                return "Simbody " + label + " accuracy " + scenes::short_number(accuracy(level), 2);
              },
          .make = [=](const Model& model, std::uint32_t level) -> std::unique_ptr<Peer> {
            return std::make_unique<Simbody>(
                model,
                SimbodyPlan{.method = method, .accuracy = accuracy(level), .duration = model.duration});
          }};
}

/// Makes a path of steps of one length.
PeerPath step_path(const std::string& label, SimbodyMethod method) {
  return halving_path(
      "Simbody " + label, "", [=](const Model& model, std::uint32_t steps) -> std::unique_ptr<Peer> {
        return std::make_unique<Simbody>(model, SimbodyPlan{.method = method,
                                                            .step = 1.0 / frames_per_second / steps,
                                                            .duration = model.duration});
      });
}

}  // namespace

PeerFamily simbody_family() {
  return {.name = "Simbody",
          .must_reach = 1e-3,
          .paths = {step_path("semi-explicit Euler", SimbodyMethod::semi_explicit_euler),
                    accuracy_path("semi-explicit Euler 2", SimbodyMethod::semi_explicit_euler_2),
                    accuracy_path("Verlet", SimbodyMethod::verlet),
                    accuracy_path("RK3", SimbodyMethod::runge_kutta_3),
                    accuracy_path("RK Merson", SimbodyMethod::runge_kutta_merson)}};
}

}  // namespace plumb::bench
