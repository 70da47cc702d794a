#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/world.hpp"
#include "view/exhibit/carry.hpp"
#include "view/exhibit/choices.hpp"
#include "view/exhibit/pull.hpp"

namespace plumb::view {

/// Returns the number of the last movable particle, whose mass a page calls the end mass; `no_island` if
/// there is none.
std::uint32_t end_particle(const Scene& scene);

/// The stages of a step whose times a page shows, as World::set_zones() names them.
inline constexpr std::array<std::string_view, 7> stage_names{"split", "wake",    "collide", "solve",
                                                             "sleep", "measure", "events"};

/// A side is a running world with what is to be known of it beside its state: who sleeps, which rods are
/// gone, how long rods are now.
///
/// What a running world cannot change, a new one does that goes on from its state. Its first step is that of
/// a start, so that motion differs from there on by the error of a step. All functions that change something
/// throw InputError where neither works; the side then stays as it was.
class Side {
 public:
  Side(SideStart start, const Scene& scene);

  /// Returns its name, with what was set to something else than that says.
  std::string name() const { return name_now(start_); }
  const Settings& settings() const { return start_.settings; }
  const Scene& scene() const { return scene_; }
  const World& world() const { return *world_; }

  void set(std::string_view setting, std::string_view text);
  void set_gravity(Vec3 gravity);
  void set_drag(double drag);
  void set_end_mass(double mass);
  /// One of a body cannot be cut: what holds that body is.
  void cut(std::uint32_t rod);
  void fix(std::uint32_t particle);
  /// An anchor without mass gets the mean mass of the others.
  void free(std::uint32_t particle);
  void pull(const Hand& hand);
  void let_go();
  /// Lets a rod, tackle or reel (`kind`) change its length at a rate (m/s) from the next step on; 0 ends
  /// that.
  void reel(std::string_view kind, std::uint32_t number, double rate);
  /// Adds a ball with a shape. Throws InputError in a scene where nothing has one.
  void throw_ball(Vec3 at, Vec3 velocity, double radius);

  void step(double dt);

  const StepReport& report() const { return report_; }
  double step_us() const { return step_us_; }
  /// Returns the time of each stage of the last step in µs, in the order of stage_names.
  const std::array<double, stage_names.size()>& stage_us() const { return times_->us; }
  std::uint32_t rebuilds() const { return rebuilds_; }  ///< New worlds that went on from another's state.
  const std::vector<std::uint8_t>& asleep() const { return asleep_; }  ///< By particle.
  bool is_gone(std::uint32_t rod) const { return rod_numbers_[rod] == no_rod; }
  const std::vector<std::uint32_t>& islands() const { return islands_; }

  std::vector<Vec3> positions() const;
  Stretch stretch() const;
  Energy energy() const;
  /// Returns the strain of every rod, or its pull in N; NaN if it is gone or not known.
  std::vector<float> strains() const;
  std::vector<float> tensions() const;

 private:
  struct Reeling {
    std::string kind;
    std::uint32_t number;
    double rate;
  };

  /// A world's zones write here, wherever the side is moved to.
  struct StageTimes {
    std::array<double, stage_names.size()> us{};
    std::chrono::steady_clock::time_point start{};
  };

  void time_stages();
  Settings for_world(const Settings& settings) const;
  /// Goes on in a new world of `scene` (with the rods of now) and `settings`.
  void rebuild(const Scene& scene, const Settings& settings);
  void require_particle(std::uint32_t particle) const;
  void require_rod(std::uint32_t rod) const;
  /// Lets the world change one of its settings alone, or all of them. Returns whether it did.
  bool set_alone(const Settings& now, std::string_view setting);
  bool set_in_place(const Settings& now, std::string_view setting);
  void wind(const Reeling& reeling, double dt);
  void take_events();
  void grip(const Hand& hand);
  void lose(std::uint32_t rod);
  void cut_in_new_world(std::uint32_t rod);

  SideStart start_;
  Scene scene_;  ///< With lengths, masses and anchors of now, and laws without stiffness for rods that are
                 ///< gone.
  std::unique_ptr<World> world_;
  std::vector<std::uint32_t> rod_numbers_;
  std::vector<std::uint32_t> rods_of_world_;  ///< The other way round.
  std::vector<std::uint32_t> islands_;
  std::vector<std::uint8_t> asleep_;
  std::uint32_t end_;
  std::optional<Grip> grip_;
  std::vector<Reeling> reeling_;
  StepReport report_{};
  double step_us_ = 0;
  std::unique_ptr<StageTimes> times_ = std::make_unique<StageTimes>();
  std::uint32_t rebuilds_ = 0;
};

}  // namespace plumb::view
