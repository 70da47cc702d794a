#include "relax/relax_solver.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "relax/describe.hpp"

namespace plumb::detail {
namespace {

/// Rods that start off their length by less than this share do so by the rounding of their coordinates.
constexpr double least_gap = 1e-9;

}  // namespace

// --- Layout

template <class T>
RelaxSolver<T>::RelaxSolver(std::shared_ptr<RelaxRules> rules, const Scene& scene, layouts::Packing packing)
    : rules_(std::move(rules)),
      kernels_(simd::kernels<T>(rules_->settings.isa.value_or(best_isa()))),
      block_(std::move(packing), rules_->settings.order == SweepOrder::jacobi) {
  weigh();
  const layouts::Packing& packed = block_.packing();
  for (Slot slot = 0; slot < packed.slot_vertex.size(); ++slot)
    block_.write(block_.x(), slot, scene.particles[particle_of(slot)].position);
  if (packed.coupling == layouts::Coupling::independent && !is_controlled()) pieces_ = packed.positions;
  Array<std::pair<std::uint32_t, std::uint32_t>> homes;  // each is a piece and an island in it
  homes.reserve(packed.slot_vertex.size());
  for (Slot slot = 0; slot < packed.slot_vertex.size(); ++slot)
    homes.push_back({piece_of(slot), packed.slot_island[slot]});
  std::sort(homes.begin(), homes.end());
  homes.erase(std::unique(homes.begin(), homes.end()), homes.end());
  islands_.assign(pieces_, 0);
  for (const auto& [piece, island] : homes) ++islands_[piece];
  slots_of_.assign(pieces_, {static_cast<Slot>(packed.slot_vertex.size()), 0});
  for (Slot slot = 0; slot < packed.slot_vertex.size(); ++slot) {
    auto& [first, end] = slots_of_[piece_of(slot)];
    first = std::min(first, slot);
    end = slot + 1;
  }
  away_.assign(pieces_, 0);
  rests_.assign(pieces_, 0);
  anchors_.reserve(
      static_cast<std::size_t>(std::count_if(packed.slot_vertex.begin(), packed.slot_vertex.end(),
                                             [&](std::uint32_t particle) { return !is_movable(particle); })));
  double sum = 0;
  std::size_t rods = 0;
  for (const std::uint32_t rod : packed.lane_edge) {
    if (rod == layouts::none) continue;
    const Rod& each = scene.rods[rod];
    const double length2 = rules_->constants.length2[rod], length = std::sqrt(length2);
    const double now = norm(scene.particles[each.b].position - scene.particles[each.a].position);
    const bool is_loose = each.law.is_elastic() || (each.law.one_sided && now < length);
    starts_off_length_ = starts_off_length_ || (!is_loose && std::abs(now - length) > least_gap * length);
    sum += length2;
    ++rods;
  }
  if (rods > 0) size_ = std::sqrt(sum / static_cast<double>(rods));
}

// --- Steps

template <class T>
void RelaxSolver<T>::begin_step(double dt, Team& team) {
  parts_ = team.parts();
  for (BlockGrab& grab : grabs_) grab.begin_step();
  if (wants_team()) begin_pulls(0);
  if (!is_controlled()) {
    take_substeps_of(dt / rules_->settings.substeps);
    if (leftovers_.keeps(h_) > 0) block_.begin_keeping();
  }
  block_.release_anchors();
  elapsed_ = 0;
  if (std::exchange(lengths_jump_, false) || (!has_moved_ && starts_off_length_)) block_.settle();
  for (const auto& [slot, move] : anchors_)
    block_.move_anchor(slot, (1.0 / rules_->settings.substeps) * (move.to - position(slot)));
  block_.sort_moving_anchors();
}

/// Makes displacements and kicks fit substeps of `h` seconds.
template <class T>
void RelaxSolver<T>::take_substeps_of(double h) {
  if (has_moved_ && h != h_) {
    weigh_grabs(h_);
    change_step(h);
  }
  weigh_grabs(h);
  if (!has_moved_) start_displacements(h);
  if (!has_moved_ || h != h_) kicks_stale_ = true;
  last_h_ = has_moved_ ? h_ : 0;
  h_ = h;
  if (kicks_stale_) write_kicks();
}

template <class T>
void RelaxSolver<T>::start_displacements(double h) {
  for_slots([&](Slot slot, std::uint32_t particle) {
    if (!is_movable(particle)) return;
    const Vec3 v = rules_->initial_velocities[particle];
    write_displacements(slot, rules_->verlet.start(v, acceleration(slot, h * v, h), h));
  });
}

template <class T>
void RelaxSolver<T>::change_step(double h) {
  for_slots([&](Slot slot, std::uint32_t particle) {
    if (!is_movable(particle)) return;
    T* const last = block_.displacement(0);
    const Vec3 went = block_.read(last, slot);
    block_.write(last, slot, rules_->verlet.change_step(went, acceleration(slot, went, h_), h_, h));
  });
}

template <class T>
void RelaxSolver<T>::write_kicks() {
  for_slots([&](Slot slot, std::uint32_t) {
    block_.write(block_.kick(), slot, rules_->verlet.kick(acceleration(slot), h_));
  });
  kicks_stale_ = false;
}

template <class T>
RelaxSettings<T> RelaxSolver<T>::settings_for(double rods, double share) {
  const Settings& settings = rules_->settings;
  const double budget = settings.stop.budget_us.value_or(0) / settings.substeps;
  return {&kernels_,
          rules_->verlet.gradient,
          settings.order,
          settings.stop,
          settings.substeps,
          static_cast<T>(rules_->verlet.decay(h_)),
          budget * share * rods / std::max(1.0, double{1} * rules_->relaxed_rods),
          law_terms(last_h_),
          law_terms(h_),
          pull_of_moves(last_h_),
          pull_of_moves(h_),
          h_,
          0,
          leftovers_,
          &rules_->constants,
          {grabs_, rules_->verlet.kick({1, 0, 0}, h_).x, h_, rules_->verlet.decay(h_)}};
}

/// A pull acts as gravity does, from the middle of the last substep to that of this one. Gradient mid begins
/// and ends where the substep does.
template <class T>
simd::LawTerms<T> RelaxSolver<T>::law_terms(double last) const {
  if (!block_.gives()) return {};
  const auto terms = [](double damping, double share, double kick, double before, double keep,
                        double substep) {
    return simd::LawTerms<T>{static_cast<T>(damping), static_cast<T>(share), static_cast<T>(kick),
                             static_cast<T>(before),  static_cast<T>(keep),  static_cast<T>(substep)};
  };
  if (rules_->verlet.gradient == Gradient::mid) return terms(h_ / 2, 0.5, h_ * h_ / 2, 0, 0, 0);
  const double between = (h_ + last) / 2, mean = mean_decay(rules_->verlet.drag * between);
  if (rules_->verlet.gradient == Gradient::new_)
    return terms(mean * between, 1, mean * h_ * between, 0, 0, 0);
  const double own = mean * h_ * h_ / 2;
  return terms(own / h_, 0.5, own, last > 0 ? mean * h_ : 0, h_ / 2 / own, h_);
}

template <class T>
double RelaxSolver<T>::advance(std::uint32_t piece, double h, std::uint32_t count, unsigned, Tally& report) {
  const std::uint32_t positions = block_.packing().positions;
  const std::uint32_t begin = pieces_ > 1 ? piece : 0, end = pieces_ > 1 ? piece + 1 : positions;
  if (is_controlled()) {
    take_substeps_of(h);
    for (const auto& [slot, move] : anchors_) block_.write(block_.kick(), slot, h * move.velocity());
  }
  RelaxSettings<T> settings = settings_for(block_.rods(begin, end), parts_);
  settings.substeps = count;
  if (is_controlled()) settings.start = std::exchange(elapsed_, elapsed_ + h * count);
  relax_alone(block_, begin, end, settings, report);
  if (is_controlled()) {
    block_.count_substeps(count);
    has_moved_ = true;
  }
  return 0;
}

template <class T>
bool RelaxSolver<T>::wants_team() const {
  return !is_controlled() && block_.packing().coupling != layouts::Coupling::independent &&
         block_.rods() >= rules_->shared_rods;
}

template <class T>
void RelaxSolver<T>::advance_with_team(double, std::uint32_t count, Team& team, StepReport& report) {
  RelaxSettings<T> settings = settings_for(block_.rods(), 1);
  for (std::uint32_t i = 0; i < count; ++i, settings.leftovers.pass(h_))
    relax_block(block_, settings, i, report, team);
}

template <class T>
void RelaxSolver<T>::end_step(StepReport&) {
  if (is_controlled()) return;  // advance() has done that, unless another solver has moved all
  if (!wants_team()) block_.count_substeps(rules_->settings.substeps);
  for (std::uint32_t i = 0; i < rules_->settings.substeps; ++i) leftovers_.pass(h_);
  if (!leftovers_.any()) block_.end_keeping();
  has_moved_ = true;
}

template <class T>
template <class F>
void RelaxSolver<T>::for_slots(F&& f) {
  const auto& vertices = block_.packing().slot_vertex;
  for (Slot slot = 0; slot < vertices.size(); ++slot)
    if (!block_.is_frozen(slot) && rests_[piece_of(slot)] == 0) f(slot, vertices[slot]);
}

// --- Accuracy

template <class T>
ErrorModel RelaxSolver<T>::error_model() const {
  // Beyond these a finer step would need more sweeps, not more substeps.
  return {.order = rules_->verlet.gradient == Gradient::new_ ? 1u : 2u,
          .by_comparison = true,
          .most_substeps = sizeof(T) == 4 ? 1u << 8 : 1u << 12};
}

template <class T>
void RelaxSolver<T>::save(std::uint32_t, Saved which) {
  Motion& to = saved_[static_cast<int>(which)];
  const std::size_t n = block_.packing().elements;
  const layouts::AlignedBuffer<T>& half_kick = block_.half_kick();
  if (to.x.size() == 0)
    to = {layouts::AlignedBuffer<T>(n),
          layouts::AlignedBuffer<T>(n),
          layouts::AlignedBuffer<T>(n),
          layouts::AlignedBuffer<T>(half_kick.size()),
          block_.pulls(),
          {}};
  std::copy_n(block_.x(), n, to.x.data());
  std::copy_n(block_.displacement(0), n, to.last.data());
  std::copy_n(block_.displacement(1), n, to.before.data());
  std::copy_n(half_kick.data(), half_kick.size(), to.half_kick.data());
  to.pulls = block_.pulls();
  block_.save_rods(to.rods);
  std::tie(to.h, to.elapsed, to.grabs, to.has_moved) = std::tie(h_, elapsed_, grabs_, has_moved_);
}

template <class T>
void RelaxSolver<T>::restore(std::uint32_t, Saved which) {
  const Motion& from = saved_[static_cast<int>(which)];
  const std::size_t n = block_.packing().elements;
  std::copy_n(from.x.data(), n, block_.x());
  std::copy_n(from.last.data(), n, block_.displacement(0));
  std::copy_n(from.before.data(), n, block_.displacement(1));
  std::copy_n(from.half_kick.data(), from.half_kick.size(), block_.half_kick().data());
  block_.pulls() = from.pulls;
  block_.restore_rods(from.rods);
  kicks_stale_ = kicks_stale_ || h_ != from.h;
  std::tie(h_, elapsed_, grabs_, has_moved_) = std::tie(from.h, from.elapsed, from.grabs, from.has_moved);
}

template <class T>
void RelaxSolver<T>::mark(std::uint32_t) {
  const std::size_t n = block_.packing().elements;
  if (mark_.size() == 0) mark_ = layouts::AlignedBuffer<T>(n);
  std::copy_n(block_.x(), n, mark_.data());
}

template <class T>
double RelaxSolver<T>::distance_from_mark(std::uint32_t) const {
  // Every slot comes once, by its island; islands lie one after the other in packings.
  double worst = 0, sum = 0;
  std::uint32_t island = layouts::none, particles = 0;
  const auto finish = [&] {
    if (particles > 0) worst = std::max(worst, sum / particles);
    sum = particles = 0;
  };
  const layouts::Packing& packing = block_.packing();
  for (Slot slot = 0; slot < packing.slot_vertex.size(); ++slot) {
    if (packing.slot_island[slot] != island) finish();
    island = packing.slot_island[slot];
    if (!is_movable(packing.slot_vertex[slot])) continue;
    const Vec3 apart = position(slot) - block_.read(mark_.data(), slot);
    sum += dot(apart, apart);
    ++particles;
  }
  finish();
  return std::sqrt(worst);
}

// --- Sleep

template <class T>
bool RelaxSolver<T>::is_slower(std::uint32_t piece, double speed) const {
  const double most = speed * h_;
  const auto [first, end] = slots_of_[piece];
  for (Slot slot = end; slot-- > first;) {  // the tip mostly comes first, and moves most
    if (piece_of(slot) != piece) continue;
    const Vec3 last = block_.read(block_.displacement(0), slot);
    if (!(std::abs(last.x) <= most && std::abs(last.y) <= most && std::abs(last.z) <= most)) return false;
  }
  return true;
}

template <class T>
void RelaxSolver<T>::rest(std::uint32_t piece) {
  rests_[piece] = 1;
  for (Slot slot = slots_of_[piece].first; slot < slots_of_[piece].second; ++slot) {
    if (piece_of(slot) != piece) continue;
    block_.write(block_.displacement(0), slot, {});
    block_.write(block_.displacement(1), slot, {});
  }
}

template <class T>
void RelaxSolver<T>::wake(std::uint32_t piece) {
  rests_[piece] = 0;
  kicks_stale_ = true;  // they were not written while it rested
}

// --- Particles

template <class T>
Vec3 RelaxSolver<T>::velocity(Slot slot) const {
  if (!has_moved_) return rules_->initial_velocities[particle_of(slot)];
  return rules_->verlet.velocity(
      {block_.read(block_.displacement(0), slot), block_.read(block_.displacement(1), slot)}, h_);
}

template <class T>
void RelaxSolver<T>::add_to_hash(Slot slot, StateHash& hash) const {
  for (const T* field : {block_.x(), block_.displacement(0)}) hash.add<T>(block_.read(field, slot));
}

template <class T>
double RelaxSolver<T>::read(std::span<const Slot> slots, std::span<Vec3> out) const {
  double most = 0;  // it is the largest square of a speed
  for (std::size_t i = 0; i < slots.size(); ++i) {
    out[i] = position(slots[i]);
    const Vec3 v = has_moved_ ? (1 / h_) * block_.read(block_.displacement(0), slots[i])
                              : rules_->initial_velocities[particle_of(slots[i])];
    most = std::max(most, dot(v, v));
  }
  return std::sqrt(most);
}

template <class T>
void RelaxSolver<T>::set_motion(Slot slot, Vec3 position, Vec3 velocity) {
  block_.write(block_.x(), slot, position);
  rules_->initial_velocities[particle_of(slot)] = velocity;
  if (!has_moved_) return;
  write_displacements(slot, rules_->verlet.start(velocity, acceleration(slot, h_ * velocity, h_), h_));
}

template <class T>
void RelaxSolver<T>::set_away(Slot slot, bool away) {
  auto& count = away_[piece_of(slot)];
  away ? ++count : --count;
}

// --- Settings and reports

template <class T>
bool RelaxSolver<T>::set_stop_rule(const StopRule& rule) {
  rules_->settings.stop = rule;
  return true;
}

template <class T>
bool RelaxSolver<T>::set_weights(Weights weights) {
  rules_->settings.weights = weights;
  weigh();
  return true;
}

template <class T>
void RelaxSolver<T>::describe(WorldInfo& info) const {
  info.relaxed_rods += block_.rods();
  info.skipped_per_rod_weights += block_.uniform_rods();
  add_to_list(info.blocks, plumb::detail::describe(block_));
}

template class RelaxSolver<float>;
template class RelaxSolver<double>;

}  // namespace plumb::detail
