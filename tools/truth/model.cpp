#include "truth/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

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

/// Says how long a scene's rods are, and how far fixed particles without one are apart.
class LengthTable {
 public:
  struct Entry {
    Real length;
    bool elastic, clamps;
  };
  LengthTable(const Scene& scene, const Model& model) : scene_(scene) {
    for (const ModelRod& rod : model.rods)
      rods_[std::minmax(rod.a, rod.b)] = {.length = rod.length, .elastic = rod.elastic, .clamps = false};
  }
  Entry of(std::uint32_t a, std::uint32_t b) const {
    const auto at = rods_.find(std::minmax(a, b));
    if (at != rods_.end()) return at->second;
    return {.length = norm(between(a, b)), .elastic = false, .clamps = true};
  }
  /// Returns the vector from a to b at the start, in m.
  Point between(std::uint32_t a, std::uint32_t b) const {
    return point_of(scene_.particles[b].position) - point_of(scene_.particles[a].position);
  }

 private:
  const Scene& scene_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Entry> rods_;
};

Real fold_of(const ModelBend& bend, const LengthTable& lengths) {
  const Point w = (1 / bend.first) * lengths.between(bend.a, bend.b) -
                  (1 / bend.second) * lengths.between(bend.b, bend.c);
  return dot(w, w);
}

ModelBend bend_of(const Bend& bend, std::size_t i, const LengthTable& lengths) {
  const std::string name = "bend " + std::to_string(i);
  if (bend.damping > 0) throw InputError(name + " is damped, which a truth does not know");
  ModelBend out{.a = bend.a,
                .b = bend.b,
                .c = bend.c,
                .first = lengths.of(bend.a, bend.b).length,
                .second = lengths.of(bend.b, bend.c).length,
                .stiffness = bend.stiffness,
                .rest = 2 * std::tan(Real{bend.angle} / 2)};
  const Real fold = fold_of(out, lengths);
  if (!(fold < most_fold)) throw InputError(name + " starts folded by more than 165.6 degrees");
  if (out.rest > 0 && !(fold > 0))
    throw InputError(name + " has a rest angle and starts straight, where its pull has no direction");
  return out;
}

ModelTwist twist_of(const Twist& twist, std::size_t i, const LengthTable& lengths) {
  ModelTwist out{.particles = twist.particles, .lengths = {}, .angle = twist.angle};
  Real length = 0;
  for (std::size_t k = 1; k < twist.particles.size(); ++k) {
    const LengthTable::Entry rod = lengths.of(twist.particles[k - 1], twist.particles[k]);
    if (rod.elastic)
      throw InputError("twist " + std::to_string(i) + " is of elastic rods, which a truth does not know");
    out.lengths.push_back(rod.length);
    if (!rod.clamps) length += rod.length;
  }
  out.stiffness = twist.stiffness / length;
  return out;
}

/// Returns the speed in m/s that all mass would have if it got the energy that elastic rods, bends and twists
/// start with.
Real elastic_speed(const Scene& scene, const Model& model) {
  Real twice_energy = 0, mass = 0;
  for (const ModelRod& rod : model.rods) {
    if (!rod.elastic) continue;
    const Vec3 &a = scene.particles[rod.a].position, &b = scene.particles[rod.b].position;
    const Real excess = norm(point_of(b) - point_of(a)) - rod.length;
    twice_energy += rod.stiffness * excess * excess;
  }
  const LengthTable lengths(scene, model);
  for (const ModelBend& bend : model.bends) {
    const Real fold = fold_of(bend, lengths), off = std::sqrt(fold / (1 - fold / 4)) - bend.rest;
    twice_energy += bend.stiffness * off * off;
  }
  for (const ModelTwist& twist : model.twists) twice_energy += twist.stiffness * twist.angle * twist.angle;
  for (std::size_t i = 0; i < model.particles(); ++i) mass += model.fixed[i] ? 0 : model.weight[i];
  return mass > 0 ? std::sqrt(twice_energy / mass) : 0;
}

void set_rates(const Scene& scene, std::span<const scenes::LengthRate> rates, Model& model) {
  for (const auto& [rod, rate] : rates) {
    const std::string name = "rod " + std::to_string(rod) + ", whose length changes, ";
    if (rod >= scene.rods.size()) throw InputError(name + "is unknown");
    if (!std::isfinite(rate)) throw InputError(name + "has no finite rate");
    if (scene.rods[rod].inertia) throw InputError(name + "has inertia of its own, which would change, too");
    if (!scene.bends.empty() || !scene.twists.empty())
      throw InputError(name + "belongs to a scene with bends or twists, whose stiffness would change, too");
    model.rods[rod].rate = rate;
  }
}

}  // namespace

Model make_model(const Scene& scene, MassModel mass, std::span<const scenes::LengthRate> rates) {
  validate(scene);
  Scene straight = scene;
  straight.bends.clear();
  straight.twists.clear();
  if (has_more_than_rods(straight))
    throw InputError(
        "a truth is of particles, rods, bends and twists alone: this scene has tackles, reels, bodies, "
        "joints, "
        "springs, shapes, ground, drag of joints or of rods, or sleepers");
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
  set_rates(scene, rates, model);
  const LengthTable lengths(scene, model);
  for (std::size_t i = 0; i < scene.bends.size(); ++i)
    model.bends.push_back(bend_of(scene.bends[i], i, lengths));
  for (std::size_t i = 0; i < scene.twists.size(); ++i)
    model.twists.push_back(twist_of(scene.twists[i], i, lengths));
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
  for (const ModelTwist& twist : model.twists) state.twisted.push_back(twist.angle);
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

WorstRod worst_stretch(const Model& model, const std::vector<Point>& x, Real t) {
  WorstRod worst;
  for (std::size_t i = 0; i < model.rods.size(); ++i) {
    const ModelRod& rod = model.rods[i];
    if (rod.elastic) continue;
    const Real stretch = std::abs(norm(x[rod.b] - x[rod.a]) / rod.length_at(t) - 1);
    // The comparison is written so that what is not a number wins and stays.
    if (!(stretch <= worst.stretch) && !std::isnan(worst.stretch)) worst = {stretch, i};
  }
  return worst;
}

}  // namespace plumb::truth
