#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "plumb/embedding/memory.hpp"
#include "plumb/export.hpp"
#include "plumb/scene.hpp"

namespace plumb {

class Executor;

/// Says how rods are kept at their length.
///
/// `relax` corrects one rod after the other (thesis §3.2). `direct` solves all rods of an island at once, to
/// rounding. `automatic` picks between these two for every island.
///
/// The others are what the thesis compares with: stiff springs (§3.3), Lagrange multipliers (§3.4) and
/// Featherstone's articulated bodies (§3.5). They run in double on one thread, and need plumb::reference and
/// register_reference_methods().
enum class Method : std::uint8_t { automatic, relax, direct, springs, multipliers, featherstone };

/// Holds what the table of methods says of one of them.
struct MethodInfo {
  Method method = Method::automatic;  ///< The method.
  std::string_view name{};            ///< Its name, as the command and its reports spell it.
  std::string_view moves{};           ///< What it moves, in words.
  bool moves_joints = false;          ///< Whether it moves bodies, joints, and shapes that touch.
  /// It reads these settings, of those that not every method reads.
  std::vector<std::string_view> reads{};
};

/// Returns all methods of this program, in the order of Method. Those of plumb::reference are among them once
/// they are registered.
PLUMB_API std::vector<MethodInfo> all_methods();

/// Says where on the way from the old to the new configuration a correction's direction is taken.
///
/// `new_` takes the new position: the thesis's projection, of first order, which damps. `old` takes the old
/// one: SHAKE, of second order, which breaks when a substep h exceeds 2/omega_max of the fastest wave.
///
/// `mid` takes the middle: the energy–momentum scheme, of second order. Solved directly, it keeps energy to
/// rounding; relaxed, it keeps energy to second order.
enum class Gradient : std::uint8_t { new_, old, mid };

/// Says how springs, multipliers and featherstone go through time.
///
/// The first four are forward Euler (thesis eq. 3.13), Euler with the new velocities, the midpoint rule and
/// classical Runge–Kutta. Springs also have linearised backward Euler (eq. 3.16–3.22), in equal steps or in
/// steps that keep Settings::accuracy.
enum class Integrator : std::uint8_t {
  explicit_euler,
  semi_implicit_euler,
  rk2,
  rk4,
  implicit_euler,
  adaptive_implicit_euler
};

/// Says what the springs of method springs hold together. `rigid_rods` are rods with an orientation each,
/// which springs hold at their joints (thesis §4.4.1). `particles` are held at the rods' lengths (figure
/// 3.13).
enum class SpringModel : std::uint8_t { rigid_rods, particles };

/// Says what every spring of method springs is like.
struct SpringSettings {
  SpringModel model = SpringModel::rigid_rods;  ///< What springs hold together.
  double stiffness = 1e4;                       ///< Stiffness of every spring, in N/m.
  /// Every spring has this share of the critical damping of the two masses it joins. Critical is 2
  /// sqrt(stiffness · reduced mass).
  double damping_ratio = 0.1;

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const SpringSettings&, const SpringSettings&) = default;
};

/// Says what method multipliers does against drift, since it keeps accelerations alone. It does nothing, it
/// feeds violations back (Baumgarte), or it projects positions and velocities after every substep.
enum class Stabilization : std::uint8_t { none, baumgarte, projection };

/// Says how method multipliers keeps rods at their length.
struct MultiplierSettings {
  Stabilization stabilization = Stabilization::projection;  ///< What is done against drift.
  double baumgarte_rate = 10;  ///< Rate at which a violation decays, critically damped, in 1/s.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const MultiplierSettings&, const MultiplierSettings&) = default;
};

/// Says which share of a correction each end takes. `mass` shares by inverse mass (thesis eq. 4.7). `equal`
/// gives half to each (eq. 4.6), which is another motion where masses differ.
enum class Weights : std::uint8_t { mass, equal };

/// Says in which order a sweep visits rods. Gauss–Seidel visits colour after colour. Jacobi corrects all rods
/// from the same positions. It splits each particle's mass over its rods, so that it converges and keeps
/// momentum.
enum class SweepOrder : std::uint8_t { gauss_seidel, jacobi };

/// Says in which numbers a world computes. A scene is always described in double.
enum class Precision : std::uint8_t { single, double_ };

/// Says how particles lie in memory (layouts/README.md). `automatic` picks by an island's shape.
enum class LayoutChoice : std::uint8_t { automatic, aos, soa, aosoa };

/// Names an instruction set with a compiled body. Every one of them gives the same bits.
enum class Isa : std::uint8_t { scalar, sse2, avx2, avx512, neon, simd128 };

/// Returns all instruction sets, slowest first, whether this processor runs them or not.
PLUMB_API std::span<const Isa> all_isas();
/// Returns whether this processor runs `isa` and this build holds it; `scalar` is always supported.
PLUMB_API bool is_supported(Isa isa);
/// Returns the best instruction set that is supported.
PLUMB_API Isa best_isa();

/// Says when sweeping stops in a substep. A tolerance or a budget can stop earlier than `sweeps` does.
/// StepReport::stopped_by says what did.
struct StopRule {
  std::uint32_t sweeps = 10;  ///< Most sweeps a substep makes; at least 1.
  /// Relaxation stops when the absolute strain of every rod of a block is within this. A larger value takes
  /// fewer sweeps and stretches rods more.
  ///
  /// Method direct uses it for nets that it solves by their lines, with gradient old or new. It must then lie
  /// between 1e-11 and 1e-2 of their mean rod. Without a tolerance it solves them to 1e-11. Where an accuracy
  /// is set, the bound is the least of the tolerance, a hundredth of the accuracy and 1e-6. All else is
  /// solved to rounding.
  std::optional<double> tolerance{};
  std::optional<double>
      budget_us{};  ///< Most time of sweeping per step(), in microseconds. Results then depend on the clock.
};

/// Holds what contact and sleep go by: lengths and speeds for things of about a metre, and shares.
struct ContactSettings {
  /// Every length and speed here is multiplied by this. Give 0.01 for things of a centimetre, or 100 where a
  /// scene counts in centimetres.
  double length_scale = 1;
  /// Shapes within this distance (m) of each other are kept from touching. A larger one finds contacts
  /// earlier and costs rows.
  double margin = 2e-3;
  /// This overlap (m) is left as it is, so that what lies on something keeps touching it. A larger one lets
  /// things sink in deeper.
  double slop = 5e-4;
  /// A substep takes back this share of an overlap beyond the slop, and of an angle beyond its limit. One
  /// that is cut takes back less in proportion. A larger share ends overlaps sooner and throws things apart
  /// faster.
  double recovery = 0.1;
  /// Nothing bounces that approaches more slowly than this (m/s), because it would bounce for ever. A larger
  /// speed lets things come to rest sooner.
  double bounce_speed = 0.05;
  /// A substep may miss a gap by this much (m). One that misses more is taken again, shorter. A larger value
  /// repeats fewer substeps and lets shapes overlap more.
  double tolerance = 1e-5;
  /// The last sweep over contacts may change this share of what gravity does in a substep. A larger share
  /// takes fewer sweeps and leaves larger errors. At 4e-3 toppling figures lie within 0.1 mm of where tighter
  /// sweeps leave them after 1.6 s.
  double sweep_tolerance = 4e-3;
  /// Islands that something holds are at rest below this speed (m/s). After Settings::sleep_time they sleep.
  /// It is that of their fastest particle or, where they are relaxed, the root mean square by mass. What
  /// changes its mean velocity by half of this within that time stays awake, as where a pendulum turns.
  double sleep_speed = 0.02;

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const ContactSettings&, const ContactSettings&) = default;
};

/// Says how a scene is simulated. Settings that are not set stand for what gradient_of(), integrator_of() and
/// mass_model_of() say.
struct Settings {
  Method method = Method::automatic;         ///< What keeps rods at their length.
  Precision precision = Precision::double_;  ///< Loops that are solved directly take double anyway.
  std::optional<Gradient> gradient{};  ///< None: new_ for relax; mid for direct, old for joints; auto picks.
  std::optional<MassModel> mass{};     ///< None: lumped for relax, which has no other; else consistent.
  Weights weights = Weights::mass;     ///< How relaxation shares a correction.
  SweepOrder order = SweepOrder::gauss_seidel;  ///< In which order relaxation visits rods.
  double omega = 1;                             ///< Over-relaxation factor of a sweep, in (0, 2).
  std::uint32_t substeps = 1;                   ///< h = dt / substeps; the fewest if an accuracy is set.
  /// Order of direct's substeps with gradient old: 2, 4 or 6. The error falls with that power of their
  /// length. A substep is composed of 1, 5 or 9 shorter ones, some backwards (Suzuki 1990; Kahan and Li
  /// 1997). With 4 or 6, linkages alone in the air take Runge-Kutta steps of that order; touching ones stay
  /// at order 2.
  std::uint32_t time_order = 2;
  /// The estimated error grows by no more than this share of the scene's diagonal per second. It picks
  /// substeps, for relax, direct and automatic, and for springs with adaptive_implicit_euler. A larger value
  /// takes fewer substeps.
  std::optional<double> accuracy{};
  /// Bounds the work of an island in a step: Newton steps, sweeps, substeps and cuts of substeps, those of
  /// repeated tries included. Tries for an accuracy get half of it.
  ///
  /// An island that has spent it takes the substeps that are asked for by number, and hardly cuts them any
  /// more, so that it may overshoot a little. It is counted (StepReport::capped_steps).
  std::uint64_t most_work = 20'000;
  StopRule stop{};                         ///< When relaxation stops sweeping.
  std::optional<Integrator> integrator{};  ///< None: implicit_euler for springs, else rk4.
  SpringSettings springs{};                ///< What method springs uses.
  MultiplierSettings multipliers{};        ///< What method multipliers uses.
  /// Islands that touch something sleep once they are slow, if this is true. Islands of particles and rods
  /// that stand still but for rounding always do. Sleepers cost nothing until they wake.
  bool sleep = true;
  /// Whether World::tension(), reaction(), contact_force() and their like are known, for 2 to 60 % more time.
  bool tensions = false;
  /// Whether World::contacts() lists the pairs that touch, for 1 to 13 % more time.
  bool contacts = false;
  /// Whether World::events() lists what fell asleep, woke, broke or went wrong.
  bool events = false;
  double sleep_time = 0.5;                        ///< Time (s) that an island is at rest before it sleeps.
  ContactSettings contact{};                      ///< Lengths, speeds and shares of contact.
  LayoutChoice layout = LayoutChoice::automatic;  ///< How particles lie in memory.
  std::optional<Isa> isa{};                       ///< None: best_isa().
  unsigned threads = 0;                           ///< 0: as many as the executor offers. At most 64 are used.
  Executor* executor = nullptr;  ///< None: make_default_executor(). It must outlive the World.
  /// What a world gets the memory of its arrays from. It must outlive the World, and be safe to use from
  /// several threads at once unless `threads` is 1. None: the heap.
  MemoryResource* memory = nullptr;
  /// Most bytes that arrays of a world take when it begins (WorldInfo::memory). A larger scene is refused.
  std::optional<std::size_t> most_memory{};
};

/// Returns the gradient that settings stand for, which depends on the method if none is set.
PLUMB_API Gradient gradient_of(const Settings& settings);
/// Returns the integrator that settings stand for, which depends on the method if none is set.
PLUMB_API Integrator integrator_of(const Settings& settings);
/// Returns the mass model that settings stand for, which depends on the method if none is set.
PLUMB_API MassModel mass_model_of(const Settings& settings);

/// Refuses settings that make no sense: omega outside (0, 2), no substeps, no sweeps and the like. Throws
/// InputError with the setting and the reason, also for an instruction set that is not supported.
PLUMB_API void validate(const Settings& settings);
/// Refuses a rule without sweeps. Throws InputError also if a tolerance or a budget is not positive and
/// finite.
PLUMB_API void validate(const StopRule& rule);

/// @{
/// Returns the name of a choice, as the command and its reports spell it.
PLUMB_API std::string_view to_string(Method);
PLUMB_API std::string_view to_string(Precision);
PLUMB_API std::string_view to_string(Gradient);
PLUMB_API std::string_view to_string(MassModel);
PLUMB_API std::string_view to_string(Weights);
PLUMB_API std::string_view to_string(SweepOrder);
PLUMB_API std::string_view to_string(Integrator);
PLUMB_API std::string_view to_string(SpringModel);
PLUMB_API std::string_view to_string(Stabilization);
PLUMB_API std::string_view to_string(LayoutChoice);
PLUMB_API std::string_view to_string(Isa);
/// @}

}  // namespace plumb
