#include <algorithm>
#include <cmath>
#include <cstddef>

#include "direct/laws/pulls_ahead.hpp"
#include "direct/trees/tree_solver.hpp"

namespace plumb::detail {
namespace {

/// Returns the number of a rod in the arrays of rods to parents, or in those of ties.
template <class Part>
auto& number_of(Part& part, Slot rod, Slot ties_begin) {
  return rod >= ties_begin ? part.ties[rod - ties_begin] : part.rods[rod];
}

}  // namespace

template <class T>
Slot TreeSolver<T>::rod_slot(std::uint32_t node, std::uint32_t lane) const {
  if (line_ && line_->segments.begins(node)) return ties_begin_ + line_->segments.lane(node);
  return node_slot(node, lane);
}

template <class T>
void TreeSolver<T>::make_laws() {
  TreeLaws<T>& laws = state_.laws;
  if (laws.any) return;
  laws.make(state_.mu.size(), state_.tie_mu.size(), state_.lanes);
  for (std::size_t i = 0; i < state_.length2.size(); ++i) laws.length.rods[i] = std::sqrt(state_.length2[i]);
  for (std::size_t k = 0; k < state_.tie_length2.size(); ++k)
    laws.length.ties[k] = std::sqrt(state_.tie_length2[k]);
  for (auto& saved : saved_)
    if (saved) saved->laws.make(state_.mu.size(), state_.tie_mu.size(), state_.lanes);
}

template <class T>
void TreeSolver<T>::count_pulls() {
  make_laws();
  state_.laws.pulls = true;
  state_.hold.resize(state_.tie_velocity.size());
  for (auto& saved : saved_)
    if (saved) saved->hold = state_.hold;
}

/// Velocities are known then, too.
template <class T>
void TreeSolver<T>::end_piece(std::uint32_t, double, unsigned part) {
  if (!state_.laws.pulls || kind_->rules.gradient != Gradient::old) return;
  TreeWorkspace<T>& work = kind_->crews[part].work;
  find_velocities(work);
  count_pulls_ahead(line_ ? line_->whole : state_, kind_->rules.drag, work);
  if (line_) line_->segments.scatter(line_->whole, state_);
}

template <class T>
void TreeSolver<T>::take_blow(unsigned part) {
  TreeWorkspace<T>& work = kind_->crews[part].work;
  if (!line_) return kind_->stepper.take_blow(state_, work);
  line_->segments.gather(state_, line_->whole);
  kind_->stepper.take_blow(line_->whole, work);
  line_->segments.scatter(line_->whole, state_);
}

/// Keeps what was pulled as the step began. What is taken back then is none of it.
template <class T>
void TreeSolver<T>::keep_blows() {
  using Numbers = layouts::AlignedBuffer<double>;
  const auto keep = [&](const Numbers& from, const Numbers& ahead, Numbers& to) {
    if (to.size() != from.size()) to = Numbers(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
      to[i] = from[i] + (state_.u_step[i % state_.lanes] != 0 ? ahead[i] : 0);
  };
  const TreeLaws<T>& laws = state_.laws;
  keep(laws.impulse.rods, laws.ahead.rods, state_.laws.blow.rods);
  keep(laws.impulse.ties, laws.ahead.ties, state_.laws.blow.ties);
}

template <class T>
double TreeSolver<T>::blow(Slot rod) const {
  const bool known = state_.laws.moves && state_.laws.blow.rods.size() > 0;
  return known ? number_of(state_.laws.blow, rod, ties_begin_) : 0;
}

template <class T>
double TreeSolver<T>::pull(Slot rod, double dt) const {
  return number_of(state_.laws.impulse, rod, ties_begin_) / dt;
}

template <class T>
void TreeSolver<T>::read_pulls(std::span<const Place> rods, double dt, double* out) const {
  for (const Place& rod : rods) *out++ = number_of(state_.laws.impulse, rod.slot, ties_begin_) / dt;
}

template <class T>
Vec3 TreeSolver<T>::hold(Slot slot, double dt) const {
  const bool is_elsewhere = away_ || state_.idle[place_of(slot).lane] != 0;
  return state_.hold.empty() || is_elsewhere ? Vec3{} : 1 / dt * state_.hold[slot - ties_begin_];
}

template <class T>
bool TreeSolver<T>::is_broken(Slot rod) const {
  if (!state_.laws.breaks) return false;
  const bool tie = rod >= ties_begin_;
  const std::size_t at = tie ? rod - ties_begin_ : rod, lanes = state_.lanes;
  const T* const numbers = (tie ? state_.laws.law.ties : state_.laws.law.rods).data() +
                           simd::tree_fields::law * (at / lanes) * lanes + at % lanes;
  // Only a broken rod neither stretches, damps nor is rigid.
  return numbers[0] == 0 && numbers[lanes] == 0 && numbers[2 * lanes] == 0;
}

template <class T>
void TreeSolver<T>::set_length(Slot rod, double length, double rate) {
  make_laws();
  state_.laws.gives = state_.laws.moves = true;
  double& last = number_of(state_.laws.rate, rod, ties_begin_);
  see_change({number_of(state_.laws.length, rod, ties_begin_), last}, {length, rate});
  number_of(state_.laws.jump, rod, ties_begin_) = rate - last;
  last = rate;
  number_of(state_.laws.length, rod, ties_begin_) = length;
  (rod >= ties_begin_ ? state_.tie_length2[rod - ties_begin_] : state_.length2[rod]) = length * length;
}

template <class T>
void TreeSolver<T>::set_gravity(Vec3 gravity, Vec3) {
  for (std::uint32_t lane = 0; lane < state_.lanes; ++lane) {
    if (kind_->rules.gradient == Gradient::old) keep_velocities(lane);
    state_.set_gravity(lane, gravity);
  }
}

template <class T>
void TreeSolver<T>::fit(bool is_off) {
  if (is_off) {
    layouts::AlignedBuffer<T> velocities(state_.u.size());  // which would move what is projected
    std::swap(velocities, state_.u);
    if (line_) line_->segments.gather(state_, line_->whole);
    project_positions();
    std::swap(velocities, state_.u);
  }
  project_velocities();
}

#define PLUMB_INSTANTIATE(T)                                                              \
  template void TreeSolver<T>::fit(bool);                                                 \
  template void TreeSolver<T>::set_gravity(Vec3, Vec3);                                   \
  template Slot TreeSolver<T>::rod_slot(std::uint32_t, std::uint32_t) const;              \
  template void TreeSolver<T>::make_laws();                                               \
  template void TreeSolver<T>::end_piece(std::uint32_t, double, unsigned);                \
  template void TreeSolver<T>::count_pulls();                                             \
  template void TreeSolver<T>::take_blow(unsigned);                                       \
  template void TreeSolver<T>::keep_blows();                                              \
  template double TreeSolver<T>::blow(Slot) const;                                        \
  template double TreeSolver<T>::pull(Slot, double) const;                                \
  template void TreeSolver<T>::read_pulls(std::span<const Place>, double, double*) const; \
  template Vec3 TreeSolver<T>::hold(Slot, double) const;                                  \
  template bool TreeSolver<T>::is_broken(Slot) const;                                     \
  template void TreeSolver<T>::set_length(Slot, double, double);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
