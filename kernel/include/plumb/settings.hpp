#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"

namespace plumb {

class Executor;

/// How rods are kept at their length. `relax`: one after the other (thesis §3.2). `direct`: all rods of an
/// island at once, to rounding. `automatic` picks between the two for every island. The others are those that
/// the thesis compares with, in double and on one thread: stiff springs (§3.3), Lagrange multipliers (§3.4)
/// and Featherstone's articulated bodies (§3.5).
enum class Method : std::uint8_t { automatic, relax, direct, springs, multipliers, featherstone };

/// Where on the way from the old to the new configuration a correction's direction is taken:
/// the new position (the thesis's projection: first order, damps), the old one (SHAKE: second order,
/// breaks when h > 2/omega_max), or the middle (second order, as in energy-momentum
/// schemes; relaxed, it keeps energy to second order).
enum class Gradient : std::uint8_t { new_, old, mid };

/// How springs, multipliers and featherstone go through time: forward Euler (thesis eq. 3.13), Euler with the
/// new velocities, the midpoint rule, classical Runge–Kutta; for springs also backward Euler, linearised
/// (eq. 3.16–3.22), in equal steps or in steps that keep Settings::accuracy.
enum class Integrator : std::uint8_t {
  explicit_euler,
  semi_implicit_euler,
  rk2,
  rk4,
  implicit_euler,
  adaptive_implicit_euler
};

/// What the springs of method springs hold together: rods, rigid bodies with an orientation each, at their
/// joints (thesis §4.4.1), or particles at the rods' lengths (figure 3.13).
enum class SpringModel : std::uint8_t { rigid_rods, particles };

struct SpringSettings {
  SpringModel model = SpringModel::rigid_rods;
  double stiffness = 1e4;  ///< N/m, of every spring
  /// Of every spring, relative to the critical damping of the two masses it joins: 2 sqrt(stiffness · reduced
  /// mass).
  double damping_ratio = 0.1;

  friend constexpr bool operator==(const SpringSettings&, const SpringSettings&) = default;
};

/// What method multipliers does against drift, since accelerations alone are kept: nothing, Baumgarte's
/// feedback, or a projection of positions and velocities after every substep.
enum class Stabilization : std::uint8_t { none, baumgarte, projection };

struct MultiplierSettings {
  Stabilization stabilization = Stabilization::projection;
  double baumgarte_rate = 10;  ///< 1/s, at which a violation decays, critically damped

  friend constexpr bool operator==(const MultiplierSettings&, const MultiplierSettings&) = default;
};

/// Which share of a correction each end takes: by inverse mass (thesis eq. 4.7) or half each (eq. 4.6).
enum class Weights : std::uint8_t { mass, equal };

/// Gauss–Seidel visits colour after colour; Jacobi corrects all rods from the same positions, each particle's
/// mass split over its rods so that it converges and keeps momentum.
enum class SweepOrder : std::uint8_t { gauss_seidel, jacobi };

enum class Precision : std::uint8_t { single, double_ };

/// How particles lie in memory; `automatic` picks by shape.
enum class LayoutChoice : std::uint8_t { automatic, aos, soa, aosoa };

/// Instruction sets with a compiled body. Every one gives the same bits.
enum class Isa : std::uint8_t { scalar, sse2, avx2, avx512 };

/// All of them, slowest first, whether this processor runs them or not.
PLUMB_API std::span<const Isa> all_isas();
/// Whether this processor runs it and this build holds it; `scalar` always is.
PLUMB_API bool is_supported(Isa isa);
/// The best that is supported.
PLUMB_API Isa best_isa();

/// When to stop sweeping in a substep. Sweeps are never more than `sweeps`; a tolerance or a budget can stop
/// earlier. What stopped sweeps is reported per step (StepReport::stopped_by).
struct StopRule {
  std::uint32_t sweeps = 10;
  /// Largest |stretch| allowed, relative to the rod's length. Method direct takes it for nets that it solves
  /// by their lines, with gradient old or new and relative to their mean rod, between 1e-11 and 1e-2: if none
  /// is set they are solved to 1e-11, and where an accuracy is set to a hundredth of that, at most 1e-6, or
  /// to this if it is less. All else it solves to rounding whatever this is.
  std::optional<double> tolerance{};
  std::optional<double>
      budget_us{};  ///< microseconds of sweeping per step(); makes results depend on the clock
};

struct Settings {
  Method method = Method::relax;
  Precision precision = Precision::double_;  ///< islands with loops solved directly: double anyway
  std::optional<Gradient> gradient{};  ///< none: new_, the thesis's, for relax; mid for direct; auto chooses
  std::optional<MassModel> mass{};     ///< none: lumped for relax, which has no other; else consistent
  Weights weights = Weights::mass;
  SweepOrder order = SweepOrder::gauss_seidel;
  double omega = 1;            ///< over-relaxation factor, in (0, 2)
  std::uint32_t substeps = 1;  ///< h = dt / substeps; the fewest if accuracy is set
  /// 2, 4 or 6, for direct with gradient old: every substep is put together from 1, 5 or 9 shorter ones, some
  /// of them backwards (Suzuki 1990; Kahan and Li 1997), so that its error falls with that power of its
  /// length.
  std::uint32_t time_order = 2;
  /// For direct, and for springs with adaptive_implicit_euler: picks substeps so that the estimated error
  /// grows by no more than this share of the scene's diagonal per second.
  std::optional<double> accuracy{};
  StopRule stop{};
  std::optional<Integrator> integrator{};  ///< none: semi_implicit_euler for springs, else rk4
  SpringSettings springs{};
  MultiplierSettings multipliers{};
  /// Of scenes with limbs that touch: whether islands that rest sleep, and cost nothing until they are woken.
  bool sleep = true;
  LayoutChoice layout = LayoutChoice::automatic;
  std::optional<Isa> isa{};      ///< none: best_isa()
  unsigned threads = 0;          ///< 0: as many as the executor offers; at most 64 are used
  Executor* executor = nullptr;  ///< none: make_default_executor(). Must outlive the World.
};

/// What settings that are not set stand for, which depends on the method.
PLUMB_API Gradient gradient_of(const Settings& settings);
PLUMB_API Integrator integrator_of(const Settings& settings);
PLUMB_API MassModel mass_model_of(const Settings& settings);

/// Throws InputError on settings that make no sense (omega outside (0, 2), no substeps, no sweeps, ...) or an
/// instruction set that is not supported.
PLUMB_API void validate(const Settings& settings);
/// Throws InputError unless sweeps are at least 1, and tolerance and budget, if given, positive and finite.
PLUMB_API void validate(const StopRule& rule);

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

}  // namespace plumb
