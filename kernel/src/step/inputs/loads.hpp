#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/loads.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Knows which forces act on particles: constant ones, and those that a load says before every step.
class Loads {
 public:
  explicit Loads(const Scene& scene);

  void set(Load load);
  bool any() const { return static_cast<bool>(load_); }

  /// Sets the constant force (N) on a particle, and returns the force that acts on it from now on.
  Vec3 set_force(std::uint32_t particle, Vec3 force);
  /// Says that a particle is fixed or free from now on. The constant force on it ends where it is fixed.
  void fix(std::uint32_t particle, bool is_fixed) {
    fixed_[particle] = is_fixed;
    if (is_fixed) constant_[particle] = {};
  }
  /// Takes at least so many particles. No force acts on new ones.
  void grow(std::size_t particles);
  /// Gives a number to a particle that was removed, or is new.
  void add(std::uint32_t particle, bool is_fixed, Vec3 velocity);
  /// Ends all forces on a particle for good.
  void remove(std::uint32_t particle);
  /// Returns all of the force (N) that acts on a particle.
  Vec3 force(std::uint32_t particle) const { return constant_[particle] + loaded(particle); }
  /// Calls f(particle, force) for every movable particle on which a force (N) acts.
  template <class F>
  void for_forces(F&& f) const {
    if (!any_constant_ && loaded_.empty()) return;
    for (std::uint32_t i = 0; i < constant_.size(); ++i)
      if (const Vec3 newton = force(i); newton != Vec3{} && !fixed_[i]) f(i, newton);
  }
  /// Returns the force (N) that a load puts on a particle, a fixed one too.
  Vec3 loaded(std::uint32_t particle) const { return loaded_.empty() ? Vec3{} : loaded_[particle]; }

  /// Asks the load for the forces of a step of `dt` (s) from `time` (s) on. at(particle) says where it goes
  /// from and how fast it starts, with is_known if the speed holds all the way, as an anchor's does. Throws
  /// what the load throws, and InputError on a force that is not finite; the last forces stay then.
  struct Motion {
    Vec3 position, velocity;
    bool is_known;
  };
  template <class At>
  void ask(double time, double dt, At&& at) {
    for (std::uint32_t i = 0; i < positions_.size(); ++i) predict(i, dt, at(i));
    ask_at(time + dt / 2, dt);
  }
  /// Lists the forces of now. The load itself is the program's.
  template <class Archive>
  void archive(Archive& archive) {
    auto& [load, fixed, any_constant, constant, loaded, asked, positions, velocities, last_velocities,
           last_dt, was_asked] = *this;
    const bool had_some = any_constant;
    archive(any_constant);
    if (any_constant)
      archive(constant);
    else if (had_some)
      std::fill(constant.begin(), constant.end(), Vec3{});
    archive(was_asked);
    if (was_asked) {
      archive(loaded, asked, last_velocities, last_dt);
    } else if (archive.restores()) {
      for (Array<Vec3>* const of : {&loaded, &asked}) std::fill(of->begin(), of->end(), Vec3{});
      last_dt = 0;
    }
    // What the load of another world said ends with the next step.
    if (archive.restores() && !load) std::fill(asked.begin(), asked.end(), Vec3{});
    if (archive.restores()) make_room(load ? constant.size() : loaded.size());
  }
  /// Takes the load of another.
  void take_load(Loads& from) {
    load_ = std::move(from.load_);
    if (load_) make_room(constant_.size());
  }
  /// Calls f(particle, force) for every movable particle whose force (N) is not what it was.
  template <class F>
  void for_changed(F&& f) {
    for (std::uint32_t i = 0; i < loaded_.size(); ++i) {
      if (!(asked_[i] == loaded_[i]) && !fixed_[i]) f(i, constant_[i] + asked_[i]);
      loaded_[i] = asked_[i];
    }
  }

 private:
  void predict(std::uint32_t particle, double dt, const Motion& motion);
  void ask_at(double middle, double dt);
  void make_room(std::size_t particles);

  Load load_;
  Array<bool> fixed_;
  bool any_constant_ = false;              ///< A constant force was ever set.
  Array<Vec3> constant_, loaded_, asked_;  ///< N, by particle; the last two once there was a load
  Array<Vec3> positions_, velocities_;     ///< as the load sees them
  Array<Vec3> last_velocities_;            ///< m/s, at the start of the last step
  double last_dt_ = 0;                     ///< s, or 0 if there was no last step
  bool was_asked_ = false;                 ///< A load has said forces, which snapshots list from then on.
};

}  // namespace plumb::detail
