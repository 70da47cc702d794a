#include "truth/model.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "plumb/error.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::truth {
namespace {

Point point_of(const Vec3& v) {
  return {v.x, v.y, v.z};
}

/// Adds a rod's mass to its ends. With s from 0 at a to 1 at b, a rod moves as (1-s) v_a + s v_b. Its kinetic
/// energy holds the moments of s over its mass.
void add_rod(Model& model, const Rod& rod, MassModel kind, ModelRod& out) {
  const Real mass = rod.mass, center = rod.center, first = mass * center;
  Real second = first;  // Lumped mass lies all at s = 0 and s = 1.
  if (kind == MassModel::consistent) {
    const Real own = rod.inertia ? *rod.inertia / (out.length * out.length) : mass / 12;
    second = first * center + own;
  }
  out.at_b = second;
  out.coupling = first - second;
  model.mass[rod.a] += mass - 2 * first + second;
  model.mass[rod.b] += second;
  model.weight[rod.a] += mass - first;
  model.weight[rod.b] += first;
}

/// Takes over how a rod answers to what pulls on it. A series in time needs a law that is smooth.
void set_law(const RodLaw& law, std::size_t i, ModelRod& out) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(
        "rod " + std::to_string(i) + " " + what +
        ", which is not smooth; a truth needs rods that are rigid or elastic, pull and push, and "
        "never break");
  };
  if (law.one_sided) refuse("is one-sided, so its pull sets in and ends suddenly");
  if (law.strength < std::numeric_limits<double>::infinity()) {
    refuse("has a finite strength, so its pull may end suddenly");
  }
  out.elastic = law.is_elastic();
  if (!out.elastic) return;
  out.stiffness = law.stiffness;
  out.damping = law.damping;
}

/// Returns the speed in m/s that all mass would have if it got the energy that elastic rods start with.
Real elastic_speed(const Scene& scene, const Model& model) {
  Real twice_energy = 0, mass = 0;
  for (const ModelRod& rod : model.rods) {
    if (!rod.elastic) continue;
    const Vec3 &a = scene.particles[rod.a].position, &b = scene.particles[rod.b].position;
    const Real excess = norm(point_of(b) - point_of(a)) - rod.length;
    twice_energy += rod.stiffness * excess * excess;
  }
  for (std::size_t i = 0; i < model.particles(); ++i) mass += model.fixed[i] ? 0 : model.weight[i];
  return mass > 0 ? std::sqrt(twice_energy / mass) : 0;
}

}  // namespace

Model make_model(const Scene& scene, MassModel mass) {
  validate(scene);
  if (has_more_than_rods(scene))
    throw InputError(
        "a truth is of particles and rods alone: this scene has bends, tackles, bodies, joints, shapes, "
        "ground, drag of joints or of rods, or sleepers");
  Model model;
  Real fastest = 0;
  for (const Particle& particle : scene.particles) {
    const Real own = particle.fixed ? 0 : particle.mass;
    model.fixed.push_back(particle.fixed);
    model.mass.push_back(own);
    model.weight.push_back(own);
    if (!particle.fixed) fastest = std::max(fastest, norm(point_of(particle.velocity)));
  }
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    ModelRod out{.a = rod.a, .b = rod.b, .length = rod.length};
    set_law(rod.law, i, out);
    if (rod.length == 0) {
      out.length =
          norm(point_of(scene.particles[rod.b].position) - point_of(scene.particles[rod.a].position));
    }
    add_rod(model, rod, mass, out);
    model.rods.push_back(out);
  }
  model.gravity = point_of(scene.gravity);
  model.drag = scene.drag;
  if (const double diagonal = bounding_diagonal(scene); diagonal > 0) model.diagonal = diagonal;
  const Real speed =
      std::max({std::sqrt(norm(model.gravity) * model.diagonal), fastest, elastic_speed(scene, model)});
  if (speed > 0) model.speed = speed;
  return model;
}

State start_of(const Scene& scene, const Model& model) {
  State state;
  for (const Particle& particle : scene.particles) {
    state.x.push_back(point_of(particle.position));
    state.v.push_back(particle.fixed ? Point{} : point_of(particle.velocity));
  }
  for (std::size_t i = 0; i < model.rods.size(); ++i) {
    const ModelRod& rod = model.rods[i];
    if (rod.elastic && !(norm(state.x[rod.b] - state.x[rod.a]) > 0)) {
      throw InputError("rod " + std::to_string(i) +
                       " is elastic and its ends start at the same place, where its pull has no direction");
    }
  }
  const WorstRod worst = worst_stretch(model, state.x);
  if (!(worst.stretch <= largest_start_stretch)) {
    throw InputError("rod " + std::to_string(worst.rod) + " starts off its length, by " +
                     scenes::short_number(static_cast<double>(worst.stretch), 3) +
                     " of it; a truth needs every rod within " + scenes::short_number(largest_start_stretch) +
                     " (leave its length out, and it is the distance of its ends)");
  }
  return state;
}

WorstRod worst_stretch(const Model& model, const std::vector<Point>& x) {
  WorstRod worst;
  for (std::size_t i = 0; i < model.rods.size(); ++i) {
    const ModelRod& rod = model.rods[i];
    if (rod.elastic) continue;
    const Real stretch = std::abs(norm(x[rod.b] - x[rod.a]) / rod.length - 1);
    // The comparison is written so that what is not a number wins and stays.
    if (!(stretch <= worst.stretch) && !std::isnan(worst.stretch)) worst = {stretch, i};
  }
  return worst;
}

}  // namespace plumb::truth
