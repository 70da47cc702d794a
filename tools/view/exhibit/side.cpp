#include "view/exhibit/side.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "plumb/error.hpp"
#include "view/exhibit/limbs.hpp"

namespace plumb::view {
namespace {

/// Pulls are known in scenes of up to so many rods, since they cost time.
constexpr std::size_t most_rods_with_tensions = 20'000;
/// A rod, tackle or reel is not reeled in further than to this share of its length at the start.
constexpr double shortest = 0.05;

/// Returns the scene with lengths that do not depend on where particles are.
Scene with_lengths(Scene scene) {
  for (std::size_t i = 0; i < scene.rods.size(); ++i) scene.rods[i].length = rod_length(scene, i);
  for (std::size_t i = 0; i < scene.tackles.size(); ++i) scene.tackles[i].length = tackle_length(scene, i);
  return scene;
}

std::vector<std::uint32_t> numbered(std::size_t n) {
  std::vector<std::uint32_t> out(n);
  std::iota(out.begin(), out.end(), 0U);
  return out;
}

/// Returns the mean mass of particles that move: what an anchor without mass weighs once it is free.
double mean_mass(const Scene& scene) {
  const std::vector<double> masses = lumped_masses(scene);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (scene.particles[i].fixed || !std::isfinite(masses[i])) continue;
    sum += masses[i];
    count += 1;
  }
  return count > 0 && sum > 0 ? sum / count : 1;
}

/// Makes a world without settings that nothing of the scene reads. The page keeps them for other methods.
std::unique_ptr<World> make_world(const Scene& scene, Settings settings) {
  for (;;) {
    try {
      return std::make_unique<World>(scene, settings);
    } catch (const UnreadSetting& error) {
      if (!forget(settings, error.setting())) throw;
    }
  }
}

}  // namespace

std::uint32_t end_particle(const Scene& scene) {
  for (auto i = static_cast<std::uint32_t>(scene.particles.size()); i > 0; --i)
    if (!scene.particles[i - 1].fixed) return i - 1;
  return no_island;
}

Side::Side(SideStart start, const Scene& scene)
    : start_(std::move(start)),
      scene_(with_lengths(scene)),
      world_(make_world(scene, for_world(start_.settings))),
      rod_numbers_(numbered(scene.rods.size())),
      rods_of_world_(rod_numbers_),
      islands_(find_islands(scene, rod_numbers_)),
      end_(end_particle(scene)) {
  for (const Particle& particle : scene.particles) asleep_.push_back(particle.asleep ? 1 : 0);
  time_stages();
}

void Side::time_stages() {
  world_->set_zones([times = times_.get()](std::string_view stage, bool begins) {
    const auto now = std::chrono::steady_clock::now();
    if (begins) {
      times->start = now;
      return;
    }
    for (std::size_t i = 0; i < stage_names.size(); ++i)
      if (stage_names[i] == stage)
        times->us[i] += std::chrono::duration<double, std::micro>(now - times->start).count();
  });
}

Settings Side::for_world(const Settings& settings) const {
  Settings out = settings;
  out.tensions = scene_.rods.size() <= most_rods_with_tensions;
  out.events = out.method == Method::automatic || out.method == Method::relax || out.method == Method::direct;
  return readable(out);
}

void Side::rebuild(const Scene& scene, const Settings& settings) {
  std::vector<std::uint8_t> asleep = asleep_;
  asleep.resize(scene.particles.size());
  Carried carried = carry(scene, *world_, {rod_numbers_, asleep});
  world_ = make_world(carried.scene, for_world(settings));
  time_stages();
  start_.settings = settings;
  scene_ = scene;
  rod_numbers_ = std::move(carried.rod_numbers);
  rods_of_world_.clear();
  for (std::uint32_t i = 0; i < rod_numbers_.size(); ++i)
    if (rod_numbers_[i] != no_rod) rods_of_world_.push_back(i);
  asleep_ = std::move(asleep);
  islands_ = find_islands(scene_, rod_numbers_);
  ++rebuilds_;
  if (!grip_) return;
  const Hand hand = grip_->hand();
  grip_.reset();  // it held in the world before
  try {
    grip_.emplace(hand, *world_, scene_, islands_);
  } catch (const InputError&) {
    // The new method takes no grabs: the hand slips.
  }
}

void Side::require_particle(std::uint32_t particle) const {
  if (particle >= scene_.particles.size())
    throw InputError("no particle " + std::to_string(particle) + "; the scene has " +
                     std::to_string(scene_.particles.size()));
}

void Side::require_rod(std::uint32_t rod) const {
  if (rod >= scene_.rods.size())
    throw InputError("no rod " + std::to_string(rod) + "; the scene has " +
                     std::to_string(scene_.rods.size()));
}

bool Side::set_alone(const Settings& now, std::string_view setting) {
  try {
    if (setting == "weights") {
      world_->set_weights(now.weights);
    } else if (setting == "substeps") {
      world_->set_substeps(now.substeps);
    } else if (setting == "sweeps" || setting == "tolerance") {
      world_->set_stop_rule(now.stop);
    } else if (setting == "accuracy" && now.accuracy) {
      world_->set_accuracy(*now.accuracy);
    } else {
      return false;
    }
  } catch (const InputError&) {
    return false;
  }
  return true;
}

bool Side::set_in_place(const Settings& now, std::string_view setting) {
  if (set_alone(now, setting)) return true;
  // What a running world refuses, a new one may take.
  try {
    world_->set_settings(now);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

void Side::set(std::string_view setting, std::string_view text) {
  Settings to = start_.settings;
  set_choice(to, setting, text);
  validate(for_world(to));
  if (set_in_place(for_world(to), setting))
    start_.settings = to;
  else
    rebuild(scene_, to);
}

void Side::set_gravity(Vec3 gravity) {
  Scene scene = scene_;
  scene.gravity = gravity;
  try {
    world_->set_gravity(gravity);
    scene_ = std::move(scene);
  } catch (const InputError&) {
    rebuild(scene, start_.settings);
  }
}

void Side::set_drag(double drag) {
  Scene scene = scene_;
  scene.drag = drag;
  rebuild(scene, start_.settings);
}

void Side::set_end_mass(double mass) {
  if (end_ == no_island) throw InputError("the scene has no particle that moves");
  Scene scene = scene_;
  scene.particles[end_].mass = mass;
  try {
    world_->set_mass(end_, mass);
    scene_ = std::move(scene);
  } catch (const InputError&) {
    rebuild(scene, start_.settings);
  }
}

void Side::lose(std::uint32_t rod) {
  rod_numbers_[rod] = no_rod;
  scene_.rods[rod].law = {.stiffness = 0};
  std::erase_if(reeling_, [&](const Reeling& each) { return each.kind == "rod" && each.number == rod; });
}

void Side::cut(std::uint32_t rod) {
  require_rod(rod);
  if (is_gone(rod)) throw InputError("rod " + std::to_string(rod) + " is out already");
  try {
    world_->cut(rod_numbers_[rod]);
    lose(rod);
    islands_ = find_islands(scene_, rod_numbers_);
  } catch (const InputError&) {
    const std::optional<Scene> severed = with_limb_severed(scene_, rod);
    severed ? rebuild(*severed, start_.settings) : cut_in_new_world(rod);
  }
}

void Side::cut_in_new_world(std::uint32_t rod) {
  const std::uint32_t number = std::exchange(rod_numbers_[rod], no_rod);
  try {
    rebuild(scene_, start_.settings);
  } catch (const InputError&) {
    rod_numbers_[rod] = number;
    throw;
  }
  lose(rod);
}

void Side::fix(std::uint32_t particle) {
  require_particle(particle);
  world_->fix(particle);
  if (grip_ && grip_->hand().particle == particle) let_go();
  scene_.particles[particle].fixed = true;
  islands_ = find_islands(scene_, rod_numbers_);
}

void Side::free(std::uint32_t particle) {
  require_particle(particle);
  Scene scene = scene_;
  Particle& freed = scene.particles[particle];
  freed.fixed = false;
  if (lumped_masses(scene)[particle] == 0) {
    freed.mass = mean_mass(scene_);
    world_->set_mass(particle, freed.mass);
  }
  world_->free(particle);
  scene_ = std::move(scene);
  islands_ = find_islands(scene_, rod_numbers_);
}

void Side::pull(const Hand& hand) {
  require_particle(hand.particle);
  if (!is_finite(hand.target)) throw InputError("the place to pull to is not finite");
  if (!grip_ || grip_->hand().particle != hand.particle) {
    Grip grip(hand, *world_, scene_, islands_);
    let_go();
    grip_ = grip;
  }
  grip_->move(*world_, scene_, hand.target);
}

void Side::let_go() {
  if (grip_) grip_->let_go(*world_);
  grip_.reset();
}

void Side::reel(std::string_view kind, std::uint32_t number, double rate) {
  const Reeling reeling{std::string(kind), number, rate};
  if (kind == "rod") {
    require_rod(number);
    if (is_gone(number)) throw InputError("rod " + std::to_string(number) + " is out");
  } else if (kind == "tackle" || kind == "reel") {
    const std::size_t all = kind == "tackle" ? scene_.tackles.size() : scene_.reels.size();
    if (number >= all) throw InputError("no " + reeling.kind + " " + std::to_string(number));
  } else {
    throw InputError("what is reeled is a rod, a tackle or a reel, not '" + reeling.kind + "'");
  }
  // An order to stay as it is, is refused where any would be.
  wind({reeling.kind, number, 0}, 0);
  std::erase_if(reeling_, [&](const Reeling& each) { return each.kind == kind && each.number == number; });
  if (rate != 0) reeling_.push_back(reeling);
}

void Side::wind(const Reeling& reeling, double dt) {
  const std::uint32_t number = reeling.number;
  if (reeling.kind == "rod") {
    double& length = scene_.rods[number].length;
    const double to = std::max(length + reeling.rate * dt, reeling.rate < 0 ? std::min(length, shortest) : 0);
    world_->set_length(rod_numbers_[number], to);
    length = to;
  } else if (reeling.kind == "tackle") {
    double& length = scene_.tackles[number].length;
    const double to = std::max(length + reeling.rate * dt, std::min(length, shortest));
    world_->set_tackle_length(number, to);
    length = to;
  } else {
    const Reel& reel = scene_.reels[number];
    double all = 0;
    for (std::size_t i = 1; i < reel.particles.size(); ++i)
      for (const Rod& rod : scene_.rods)
        if ((rod.a == reel.particles[i - 1] && rod.b == reel.particles[i]) ||
            (rod.b == reel.particles[i - 1] && rod.a == reel.particles[i]))
          all += rod.length;
    const double out = world_->reel_out(number);
    world_->set_reel(number,
                     std::clamp(out + reeling.rate * dt, std::min(out, shortest), std::max(out, all)));
  }
}

void Side::throw_ball(Vec3 at, Vec3 velocity, double radius) {
  if (!(radius > 0) || !std::isfinite(radius)) throw InputError("a ball needs a radius");
  if (scene_.capsules.empty() && scene_.hulls.empty())
    throw InputError("nothing in this scene has a shape that a ball could hit");
  // It is as dense as wood.
  const double mass = 500 * 4.1888 * radius * radius * radius;
  Scene scene = scene_;
  const auto number = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back({.position = at, .velocity = velocity, .mass = mass});
  Point place;
  place.particles[0] = number;
  place.weights[0] = 1;
  scene.capsules.push_back({.a = place, .b = place, .radius = radius});
  rebuild(scene, start_.settings);
}

void Side::step(double dt) {
  if (grip_ && !grip_->pull(*world_, scene_)) grip_.reset();
  // An order that was possible when it was given may end, as where another method came since.
  std::erase_if(reeling_, [&](const Reeling& each) {
    try {
      wind(each, dt);
      return false;
    } catch (const InputError&) {
      return true;
    }
  });
  times_->us.fill(0);
  const auto start = std::chrono::steady_clock::now();
  report_ = world_->step(dt);
  step_us_ = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  take_events();
}

void Side::take_events() {
  if (!for_world(start_.settings).events) return;
  bool has_broken = false;
  for (const Event& event : world_->events()) {
    if (event.kind == Event::Kind::broke) {
      lose(rods_of_world_[event.rod]);
      has_broken = true;
    }
    if (event.kind != Event::Kind::woke && event.kind != Event::Kind::fell_asleep) continue;
    const std::uint32_t island = islands_[event.particle];
    for (std::size_t i = 0; i < islands_.size(); ++i)
      if (islands_[i] == island) asleep_[i] = event.kind == Event::Kind::fell_asleep ? 1 : 0;
  }
  if (has_broken) islands_ = find_islands(scene_, rod_numbers_);
}

std::vector<Vec3> Side::positions() const {
  std::vector<Vec3> out(scene_.particles.size());
  world_->copy_positions(out);
  return out;
}

Stretch Side::stretch() const {
  return measure_stretch(scene_, positions());
}

Energy Side::energy() const {
  std::vector<Vec3> velocities(scene_.particles.size());
  world_->copy_velocities(velocities);
  return measure_energy(scene_, positions(), velocities, mass_model_of(start_.settings));
}

std::vector<float> Side::strains() const {
  const std::vector<Vec3> at = positions();
  std::vector<float> out(scene_.rods.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::uint32_t i = 0; i < out.size(); ++i) {
    const Rod& rod = scene_.rods[i];
    if (!is_gone(i)) out[i] = static_cast<float>(norm(at[rod.b] - at[rod.a]) / rod.length - 1);
  }
  return out;
}

std::vector<float> Side::tensions() const {
  std::vector<float> out(scene_.rods.size(), std::numeric_limits<float>::quiet_NaN());
  if (!for_world(start_.settings).tensions) return out;
  std::vector<double> pulls(world_->rod_count());
  world_->copy_tensions(pulls);
  for (std::uint32_t i = 0; i < out.size(); ++i)
    if (!is_gone(i)) out[i] = static_cast<float>(pulls[rod_numbers_[i]]);
  return out;
}

}  // namespace plumb::view
