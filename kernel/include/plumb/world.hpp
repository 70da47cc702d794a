#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "plumb/embedding/state_view.hpp"
#include "plumb/export.hpp"
#include "plumb/loads.hpp"
#include "plumb/measures.hpp"
#include "plumb/report.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/shapes/contact.hpp"

namespace plumb {

/// Holds a scene compiled for stepping.
///
/// Under methods relax and direct the state of a particle is its position and the displacement of the last
/// substep. Two stored positions would lose g·h² below one unit in the last place of a float.
///
/// A world is not thread-safe. One thread at a time may use it, reading included, since velocities are
/// computed when they are first read. Different worlds may be used at the same time.
class PLUMB_API World {
 public:
  /// Compiles a scene, and keeps a copy. Throws InputError if validate() refuses the scene or the settings,
  /// if numbers do not fit the precision or 32-bit places, or if the method cannot move the scene.
  explicit World(const Scene& scene, const Settings& settings = {});
  /// Shares the scene instead, with its caller and with other worlds. Nothing may change it as long as they
  /// live. Throws InputError on null, too.
  explicit World(std::shared_ptr<const Scene> scene, const Settings& settings = {});
  ~World();
  World(World&&) noexcept;             ///< Moves the world; views of it become invalid.
  World& operator=(World&&) noexcept;  ///< Moves the world; views of both become invalid.

  /// Advances by `dt` seconds, in Settings::substeps equal substeps; with an accuracy, in as many as it
  /// takes. Throws InputError if `dt` is not positive, beyond 10⁷ s, or too short for the precision, and what
  /// a load throws (set_load()); nothing has moved then. Throws what the executor throws; the step is then
  /// done all the same.
  ///
  /// Methods relax, direct and automatic allocate nothing after the first call, but for these firsts. An
  /// island freezes, falls back, or its rods give way. An anchor moves. More shapes touch at once than ever
  /// before, or a substep is halved beside shapes. A linkage flies with a time order above 2.
  StepReport step(double dt);

  /// Changes the rule from the next step on. Throws InputError on an unsound one, or if no island reads it.
  void set_stop_rule(const StopRule& rule);
  /// Changes the weights of relaxation from the next step on. Throws InputError if no island is relaxed.
  void set_weights(Weights weights);
  /// Takes so many equal substeps a step from the next one on (Settings::substeps); the fewest if an accuracy
  /// is set. Throws InputError on 0 and on more than a million.
  void set_substeps(std::uint32_t substeps);
  /// Changes the accuracy from the next step on (Settings::accuracy). Methods, time orders and how nets are
  /// solved stay as they were chosen for that of the start. Throws InputError unless it is positive and
  /// finite, and in a world that began without one.
  void set_accuracy(double accuracy);
  /// Fits steps into so much wall time from the next one on, or lets them take what they need, if none is
  /// given. Motion then depends on the clock. The first step guesses by its rods. Equal substeps become fewer
  /// where that makes steps shorter, at least 1. An island that is not swept takes what is left of a late
  /// step in one, or as few as do not make it dearer. With an accuracy, tries end when what is left suffices
  /// for substeps by number. StepReport::capped_steps counts islands that were less accurate than asked, and
  /// step_us tells whether the time was kept: where nothing is cheaper, it is not. Throws InputError on a
  /// time that is not positive and finite.
  void set_budget(std::optional<double> microseconds);

  /// Takes other settings from the next step on. Positions, velocities, forces, time, orders, handles, grabs
  /// and sleep stay. Snapshots then fit to worlds made with these settings. Islands are made anew, but for
  /// changes of substeps, most_work, stop, weights, omega, contact, sleep, sleep_time, isa, threads and
  /// executor alone, without set_accuracy(). The next step then takes out, without a blow, how far solved
  /// rods are off their length, which wakes them. Pulls may be NaN until then. Throws InputError, and changes
  /// nothing, on what a constructor refuses, and from or to springs, multipliers and featherstone. So it does
  /// if twists, reels, cut rods with mass or unfit grabs are made anew.
  void set_settings(const Settings& settings);
  /// Returns the settings of now, with what was changed since; valid until set_settings() or restore().
  const Settings& settings() const;

  /// Lets `zones` hear of every stage from the next step on; an empty one ends that. It must not throw.
  void set_zones(Zones zones);
  /// Tells `log` now how the scene was compiled, and from then on when troubles begin and end.
  void set_log(Log log);

  /// Sets a constant force, in N, on a movable particle, which stays until it is changed. Throws InputError
  /// on an unknown or fixed particle or a force that is not finite.
  ///
  /// A force that is set anew before every step, from the state of then, moves a scene to first order only.
  /// set_load() is of second order.
  void set_force(std::uint32_t particle, Vec3 force);
  /// Lets `load` say forces from the next step on, which add to those of set_force(); an empty one ends that.
  /// It is called once before each step and sees the middle of it: positions go on by their velocities, and
  /// velocities as in the step before. Its forces then act through the step, so that motion is of second
  /// order in the length of steps. Substeps do not refine it.
  ///
  /// step() throws what a load throws, and InputError on a force that is not finite. Nothing has moved then.
  /// Forces on fixed particles show in reaction() alone. A load may read the world, but not change it.
  void set_load(Load load);
  /// Moves an anchor to `target` (m) during the next step, along a straight line, a substep at a time. What
  /// hangs from it is dragged along as fast: 10 m in 1/60 s are 600 m/s, and more where it whips. To put it
  /// elsewhere without a blow, use teleport(). Throws InputError on an unknown or movable particle or a
  /// target that is not finite.
  void move_anchor(std::uint32_t particle, Vec3 target);
  /// Pulls a place to a target from the next step on, until it is released, and wakes its island. A grab ends
  /// by itself where its particles are removed, all fixed, or no longer of one island or rod.
  /// Throws InputError on an unknown particle, weights that do not add up to 1, fixed particles alone,
  /// numbers that are not finite, and negative stiffness or damping. So it does where a solver cannot:
  /// relaxed rods, and those without mass of their own, are grabbed at their ends. Springs, multipliers,
  /// featherstone and reels take none.
  Handle<Grab> grab(const Grab& grab);
  /// Moves the target of a grab to `target` (m) during the next step, along a straight line, which wakes its
  /// island. Then it stands. Throws InputError on a stale handle or a target that is not finite.
  void move_grab(Handle<Grab> grab, Vec3 target);
  /// Lets go. Nothing jumps. Throws InputError on a stale handle.
  void release(Handle<Grab> grab);
  /// Returns whether a handle names a grab that still holds.
  bool has(Handle<Grab> grab) const;
  /// Returns the force in N with which a grab pulled, averaged over the last step. With other forces it makes
  /// the change of momentum as reactions do. It is NaN before the first step. Throws InputError on a stale
  /// handle, or without Settings::tensions.
  Vec3 grab_force(Handle<Grab> grab) const;
  /// Returns the power in W that it gave to what it pulls, averaged likewise. What its spring holds is no
  /// part of a world's energy. Throws InputError as grab_force() does.
  double power(Handle<Grab> grab) const;
  /// Moves a platform (Scene::platforms), and the ground that it carries, to `target` during the next step,
  /// with constant velocity and spin, the shorter way round. What lies on it is carried, and sleepers wake.
  /// Then it stands still until it is moved again. Throws InputError on an unknown platform, and on a pose
  /// that validate() refuses.
  void move_platform(std::uint32_t platform, const Pose& target);
  /// Returns where a platform is. Throws InputError on an unknown one.
  Pose platform(std::uint32_t platform) const;

  /// Changes a spring, a torsion or an angle from the next step on, all but its places, and wakes its island.
  /// They are numbered as in the scene. Throws InputError on an unknown one, on what validate() refuses, and
  /// on a spring whose length becomes or was 0.
  void set_spring(std::uint32_t spring, const Spring& to);
  /// See set_spring().
  void set_torsion(std::uint32_t torsion, const Torsion& to);
  /// See set_spring(). Throws InputError, too, on a drive or damper of an angle that the scene gave neither.
  void set_angle(std::uint32_t angle, const AngleControl& to);
  /// Returns phi of a torsion in rad, with whole turns. Throws InputError on an unknown one.
  double torsion_angle(std::uint32_t torsion) const;

  /// Lets a rod become `target` (m) long in the next step, at a constant rate, as a winch does. A broken one
  /// ignores it. Throws InputError on an unknown rod, a length not positive and finite, and rods of reels,
  /// twists or fixed ends. Beside joints or shapes it does so on what gives, bends, drags or is of a body.
  /// An edit that brings such a rod there in the step of its change is refused, too.
  void set_length(std::uint32_t rod, double target);
  /// Turns the last cross section of a twist (Scene::twists) against the first, at a constant rate during the
  /// next step, as a motor at its end does. `angle` (rad) takes the place of Twist::angle. Throws InputError
  /// on an unknown twist or an angle that is not finite.
  void set_twist(std::uint32_t twist, double angle);
  /// Returns how far an unbroken chain is twisted, in rad. Throws InputError on an unknown twist.
  double twist(std::uint32_t twist) const;
  /// Returns the pull of a rod in N, averaged over the last step: negative if it pushes, and 0 after it
  /// broke. Beside bends it is the force along the rod, with what bends have of it: that in a wire. That of a
  /// relaxed rod is what sweeps found. It is NaN before the first step. Throws InputError on an unknown rod,
  /// or without Settings::tensions.
  double tension(std::uint32_t rod) const;
  /// Copies the pulls of all rods (N) into `out`, which has rod_count() elements. Throws as tension() does.
  void copy_tensions(std::span<double> out) const;
  /// Returns the power in W with which a rod that changes its length moved its island, averaged over the last
  /// step: what a winch does. It is positive where a pulling rod shortens, and 0 where lengths stay. With
  /// gradient mid it is what energy gains, to the second order in the step where a rate changes, to the first
  /// beside bends, and to rounding elsewhere. Throws InputError as tension() does.
  double power(std::uint32_t rod) const;
  /// Returns whether a rod pulled more than its strength, or was cut. Throws InputError on an unknown one.
  bool is_broken(std::uint32_t rod) const;

  /// Takes a rod out from the next step on, as one that broke: nothing jumps, and momentum stays. Bends and
  /// twists end with it. Its island goes on as the islands that it is then, and others keep their bits. It
  /// does nothing to a rod that is out. A capsule along it ends, but for spheres at ends without any other,
  /// the second with a new number. One between places that come apart ends. What lies on the island wakes.
  /// Throws InputError on an unknown rod, and where an island cannot be made anew. That is one with reels, or
  /// with a twist that does not end. So it does on a rod between particles of a body.
  void cut(std::uint32_t rod);
  /// Takes out a Rod, Pin, Alignment, AngleControl, Spring or Torsion likewise. What a pin kept from touching
  /// may touch then. All but rods lose their numbers in the next step: handles are stale then, and add() may
  /// give numbers anew. Throws InputError on a stale handle, too.
  template <class Item>
  void cut(Handle<Item> item);
  /// Joins particles, of two islands or of one, by a new Rod, Pin, Alignment, AngleControl, Spring or Torsion
  /// from the next step on. A rod's length of 0 is their distance now, and no value of an alignment that of
  /// now. Nothing jumps but velocities that a rigid rod, a pin or an alignment forbids. Those end as in an
  /// inelastic blow, which keeps momentum and angular momentum, also where sweeps go on. Its number is the
  /// lowest that is free, or new; cut() before the next step gives it back.
  /// Throws InputError as cut() does, on what validate() refuses, whose messages call it number 0, on rods
  /// that air slows, and on ends that are both fixed or joined already. It does so on rods that do not fit
  /// between their ends, and pins whose places are apart by 10^-6 of the rods at them. So it does on
  /// alignments off their value by 10^-6 of their longer direction squared, and on what would bring islands
  /// with shapes or joints together with tackles. All but rods it refuses where add() refuses joints.
  template <class Item = Rod>
  Handle<Item> join(const Item& item);
  /// Joins what handles name, whatever the ends of `rod` say. Throws InputError on stale ones, too.
  Handle<Rod> join(Handle<Particle> a, Handle<Particle> b, Rod rod = {});
  /// Fixes a particle where it is from the next step on, and takes its momentum. Forces on it end, and so do
  /// capsules between fixed ones. What hangs from it goes on with velocities that its rods and joints allow.
  /// Throws InputError as cut() does, and on particles of tackles, twists, reels and wound rods to fixed
  /// ones. So it does where a rod of a bend would have both ends fixed, or a body or joint would stand.
  void fix(std::uint32_t particle);
  /// Frees a fixed particle from the next step on, as fast as it was moved in the last one. All that hangs
  /// from it comes together. Throws InputError as fix() and join() do, if it has no mass, and if it holds a
  /// capsule or is of a body of the ground. So it does if a rigid rod to another fixed one is off its length,
  /// unless the method is relax.
  void free(std::uint32_t particle);
  /// Changes a particle's own mass (kg) from the next step on; velocities stay. Throws InputError as cut()
  /// does, and on a mass that is not positive and finite.
  void set_mass(std::uint32_t particle, double mass);
  /// Changes gravity (m/s^2) from the next step on, and wakes everything. Throws InputError on one that is
  /// not finite, and under springs, multipliers and featherstone.
  void set_gravity(Vec3 gravity);
  /// Puts particles elsewhere at once, without a blow: an anchor goes with its rope if all are listed.
  /// Velocities (m/s) of fixed ones say nothing. What they stretch of rigid rods that are solved directly is
  /// taken out, as at a start, and what is wound goes on so. Joints are not looked at. What is moved wakes
  /// up, and so does what lies on its shapes.
  /// Throws InputError on lists of other sizes, particles that are unknown or listed twice, places that are
  /// not finite and islands with a reel. So it does on a rod that would be 10^-6 of its length further off.
  void teleport(std::span<const std::uint32_t> particles, std::span<const Vec3> positions,
                std::span<const Vec3> velocities);

  /// Makes room for what edits will add, before frames count: numbers for `times` times what `like` has, and
  /// what the first edit looks at in the whole scene. Counts of particles, rods and bodies grow by it, which
  /// edits then leave as they are while room is left. Throws InputError where there would be too many, and
  /// under springs, multipliers and featherstone.
  void reserve(const Scene& like, std::uint32_t times = 1);
  /// Adds islands at once, as a world of that scene begins, with all but twists and reels. Numbers are the
  /// lowest of removed ones that are free in a row, or new, and depend on nothing but what was added and
  /// removed before. Gravity and ground are those of the world. Four islands and more that came one by one
  /// lie side by side from the next step on, as those of one scene do. Throws InputError if validate()
  /// refuses the scene, on ground, on other drag than the world's, and where the settings cannot move it. It
  /// does so on other gravity, unless that is the default of Scene. So it does on shapes, bodies, joints,
  /// springs, air on rods and sleepers in a world that began without any and without ground.
  Added add(const Scene& scene);
  /// Removes the island of a movable particle at once, as it is without edits that wait. Its fixed particles
  /// go along where nothing else hangs from them. Such a fixed one may also be removed by itself. What was
  /// ordered of all that ends. Its numbers are refused until add() gives them anew, and bulk copies are zero.
  /// Shapes, bodies, joints and springs of the island end, too. Throws InputError on islands with twists or
  /// reels, and if what is freed in the next step would stay without mass.
  void remove(std::uint32_t particle);
  /// Lets equal islands lie side by side again from the next step on, as in a world that begins with them.
  /// Edits of different steps leave islands with solvers of their own, which takes longer. Those are made
  /// anew, which takes as long as a start of them, and wake; nothing jumps. What fills its lanes keeps its
  /// bits, and so do islands with joints. Throws InputError under springs, multipliers and featherstone.
  void pack();
  /// Returns what names a Particle, Rod, Bend, Tackle, Body, Pin, Alignment, AngleControl, Spring, Torsion,
  /// Capsule or Hull for good; nothing if it was removed. Throws InputError on an unknown number.
  template <class Item>
  Handle<Item> handle(std::uint32_t number) const;
  /// Returns the number of such an item. Throws InputError on a handle that names none, or none any more.
  template <class Item>
  std::uint32_t number(Handle<Item> item) const;
  /// Returns whether a handle names an item that was neither removed nor, but for rods, cut.
  template <class Item>
  bool has(Handle<Item> item) const;

  /// Lets a tackle become `target` (m) long during the next step, at a constant rate. Throws InputError on an
  /// unknown tackle and a length that is not positive and finite.
  void set_tackle_length(std::uint32_t tackle, double target);
  /// Returns the pull of a tackle's cord in N, averaged over the last step, or NaN before the first. With
  /// friction it is that of the first segment. Throws InputError on an unknown tackle, or without
  /// Settings::tensions.
  double tackle_tension(std::uint32_t tackle) const;
  /// Returns the pull of a segment of a tackle's cord likewise. Segment 0 is between the first two particles.
  /// Throws InputError on an unknown segment, too.
  double tackle_tension(std::uint32_t tackle, std::uint32_t segment) const;
  /// Returns the power (W) of a tackle whose length changes, as power() does of a rod.
  double tackle_power(std::uint32_t tackle) const;
  /// Lets `out` metres of a reel's rope be out at the end of the next step, at a constant rate. Throws
  /// InputError on an unknown reel, and on a length that is not positive or more than the chain has.
  void set_reel(std::uint32_t reel, double out);
  /// Returns how much of a reel's rope is out, in m. Throws InputError on an unknown reel.
  double reel_out(std::uint32_t reel) const;

  /// Returns the force in N that holds an anchor against all there is, averaged over the last step. With
  /// other forces the reactions make the change of momentum, rods' mass at anchors included: to rounding with
  /// gradient mid solved directly, else to the order in the step. It is NaN where a pull is (see tension()).
  /// Throws InputError on an unknown or movable particle, or without Settings::tensions.
  Vec3 reaction(std::uint32_t particle) const;
  /// Copies the reactions (N) at all particles into `out`; those of movable ones are zero. Throws InputError
  /// unless it has particle_count() elements, or without Settings::tensions.
  void copy_reactions(std::span<Vec3> out) const;
  /// Returns the force in N that a ball joint (Scene::pins) puts on the place `a`, averaged over the last
  /// step; `b` gets the opposite. It is NaN before the first step. Throws InputError on an unknown joint, or
  /// without Settings::tensions.
  Vec3 pin_force(std::uint32_t pin) const;
  /// Returns the torque in N m with which limits, friction and drive of an angle (Scene::angles) widen it.
  /// See pin_force().
  double angle_torque(std::uint32_t angle) const;
  /// Returns the force in N that a spring (Scene::springs) puts on its place `a`. See pin_force().
  Vec3 spring_force(std::uint32_t spring) const;
  /// Returns the torque in N m that a torsion (Scene::torsions) puts on the side of `v`. See pin_force().
  double torsion_torque(std::uint32_t torsion) const;
  /// Returns the force in N with which all that touches a shape pushes it, averaged over the last step; zero
  /// if nothing does. Shapes are those of Scene::capsules, then those of Scene::hulls, then capsules
  /// and hulls that were added. Throws InputError on an unknown shape, or without Settings::tensions.
  Vec3 contact_force(std::uint32_t shape) const;
  /// Returns that of a shape or a piece of ground by name, so that ground is a scale. Of ground it is NaN
  /// before the first step. Throws InputError on a name that the scene does not have, or without
  /// Settings::tensions.
  Vec3 contact_force(ShapeId shape) const;
  /// Returns whether edits have left a shape, as they do all ground. Throws InputError on an unknown name.
  bool has_shape(ShapeId shape) const;
  /// Copies the contact forces (N) on all shapes into `out`. Throws InputError unless it has shape_count()
  /// elements, or without Settings::tensions.
  void copy_contact_forces(std::span<Vec3> out) const;

  /// Returns the pairs of shapes, not their points, that touched in the last step, and those that did in the
  /// step before alone, in the order of their names. They stay until the next step(). Pairs of a shape that
  /// was removed end. Where one that was added has its name, a pair that began may follow with both names.
  /// Impulses, with gravity and forces, make the change of momentum. Pairs that sleep persist as they were in
  /// their last step awake. Throws InputError without Settings::contacts.
  std::span<const Contact> contacts() const;

  /// Returns what became of islands and rods in the last step: what woke, fell asleep, broke, froze, and was
  /// not solved or not accurate. They stay until the next step. They are in the order of their kinds, and
  /// within a kind in that of their numbers. Throws InputError without Settings::events.
  std::span<const Event> events() const;

  /// Returns what went wrong in the last step, by particle, and which rods that are not elastic are off their
  /// length by more than `most_strain` of it. Of islands that touch each other, or have joints, rods alone
  /// are listed: StepReport counts the rest.
  std::vector<Problem> problems(double most_strain = 0.01) const;

  /// Returns a scene of what there is now, in the order of numbers, of which those that were removed are left
  /// out. A world that begins with it goes on as this one does, up to what gradients and contacts remember of
  /// the last step, and awake. Edits that wait, forces, grabs and rates of lengths are no part of it. Throws
  /// InputError under springs, multipliers and featherstone.
  Scene scene() const;
  std::uint32_t particle_count() const;  ///< Numbers of particles, with reserved and removed ones.
  std::uint32_t rod_count() const;       ///< Numbers of rods, with reserved and removed ones.
  double time() const;                   ///< Simulated time, in s.

  /// Returns positions in m, in the scene's order, as a view.
  StateView positions() const { return {*this, StateView::Field::position}; }
  /// Returns velocities in m/s at the end of the step, in the scene's order, as a view. They are as accurate
  /// as the positions, of second order for relax.
  StateView velocities() const { return {*this, StateView::Field::velocity}; }
  /// Copies positions (m) into `out`. Throws InputError unless it has particle_count() elements.
  void copy_positions(std::span<Vec3> out) const;
  /// Copies velocities (m/s) into `out`. Throws InputError unless it has particle_count() elements.
  void copy_velocities(std::span<Vec3> out) const;
  /// Returns the position of a particle, in m. Throws InputError on an unknown one.
  Vec3 position(std::uint32_t particle) const;
  /// Returns its velocity in m/s; zero for a fixed one, also while it moves. Throws InputError likewise.
  Vec3 velocity(std::uint32_t particle) const;

  std::uint32_t body_count() const;   ///< Numbers of bodies, with reserved and removed ones.
  std::uint32_t shape_count() const;  ///< Numbers of capsules and hulls, with reserved and removed ones.
  /// Returns where a body is: its centre of mass, and how it has turned since the scene, where its
  /// orientation is that of the axes of space. Of w, x, y, z the largest is positive. Where sweeps leave a
  /// strain, this is the rotation nearest to how its particles lie. Throws InputError on an unknown body.
  Pose pose(std::uint32_t body) const;
  /// Returns how a body moves, as velocities() have it. Throws InputError on an unknown body.
  BodyMotion motion(std::uint32_t body) const;
  /// Copies the poses of all bodies into `out`. Throws InputError unless it has body_count() elements.
  void copy_poses(std::span<Pose> out) const;
  /// Copies the motions of all bodies into `out`. Throws InputError unless it has body_count() elements.
  void copy_motions(std::span<BodyMotion> out) const;

  /// Returns a 64-bit FNV-1a hash of all positions and displacements, in the scene's order, or velocities
  /// under springs, multipliers and featherstone. It is equal for every instruction set and thread count.
  std::uint64_t state_hash() const;

  /// Returns how many bytes save() takes now. Contacts and what breaks change that from step to step. Throws
  /// InputError under springs, multipliers and featherstone, which keep no snapshots.
  std::size_t snapshot_size() const;
  /// Writes a snapshot of the world into `out` and returns its size in bytes. What is left of `out` stays as
  /// it is. Equal worlds give equal bytes, whatever their instruction sets and threads. Throws as
  /// snapshot_size() does, and InputError if `out` is too small.
  std::size_t save(std::span<std::byte> out) const;
  /// Goes back, or on, to a snapshot at the beginning of `from`. The future is bit for bit that of the world
  /// that was saved, and everything else that can be read is what it was there. A load (set_load()) is not
  /// part of it: the world keeps its own, which is to be set before.
  ///
  /// The snapshot may be of another world, of the same scene and settings; isa, threads and executor may
  /// differ. Throws InputError with a reason if it is not, or if bytes are cut off or changed by accident;
  /// nothing has changed then. Allocates where it needs more room than ever, or rods broke other islands up.
  void restore(std::span<const std::byte> from);

  /// Says how the scene was compiled, and what changed since. The reference stays valid while the world
  /// lives, but for restore() and set_settings(), and is up to date when this is called.
  const WorldInfo& info() const;

 private:
  friend class Drawing;
  friend class Frames;
  friend class Queries;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

inline std::size_t StateView::size() const {
  return world_->particle_count();
}
inline Vec3 StateView::operator[](std::uint32_t particle) const {
  return field_ == Field::position ? world_->position(particle) : world_->velocity(particle);
}

}  // namespace plumb
