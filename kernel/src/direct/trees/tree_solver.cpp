#include "direct/trees/tree_solver.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "direct/laws/pulls_ahead.hpp"
#include "interface/changes.hpp"
#include "time/accuracy.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {
namespace {

/// Displacements of float substeps shorter than this share of a step are rounding.
template <class T>
constexpr std::uint32_t most_substeps = sizeof(T) == 4 ? 1 << 8 : 1 << 20;

/// A tree is calm once gradient mid would need no more substeps than a step has at least. That is so if mid
/// would make this share of the error allowed in so many steps in turn. The numbers were found on chains with
/// end masses of 1 to 10,000 (at rest, swinging and whipping) and on trees of rods with mass.
constexpr double calm_rate = 0.3;
constexpr int calm_after = 2;
/// Fewer substeps of gradient old than this are no dearer than one of mid, on lines and on other trees.
constexpr std::uint32_t dear_on_lines = 4, dear_on_trees = 2;

}  // namespace

// --- Layout

template <class T>
TreeSolver<T>::TreeSolver(std::shared_ptr<TreeKind<T>> kind, std::uint32_t trees)
    : kind_(std::move(kind)), state_(kind_->topology, kind_->lanes) {
  for (std::uint32_t lane = trees; lane < state_.lanes; ++lane) state_.set_idle(lane, true);
}

template <class T>
void TreeSolver<T>::fill_lane(std::uint32_t lane, const Scene& scene, MassModel model,
                              const layouts::Tree& tree, const TreeMembers& members) {
  state_.fill_lane(lane, scene, model, tree, members);
}

template <class T>
void TreeSolver<T>::finish_layout(bool may_touch) {
  if (state_.lanes == 1 && TreeStepper<T>::is_line(state_, kind_->rules.gradient) &&
      LineSegments::fits(*state_.topology, layouts::lane_width<T>)) {
    const LineSegments segments(state_.topology->nodes, layouts::lane_width<T>);
    TreeState<T> cut = segments.cut(state_);
    line_ =
        std::make_unique<Line>(Line{segments, std::move(state_), TreeWorkspace<T>(*cut.topology, cut.lanes)});
    state_ = std::move(cut);
  }
  if (!line_ && !may_touch) kind_->make_alone();
  ties_begin_ = state_.topology->nodes * state_.lanes;
  velocity_ = layouts::AlignedBuffer<T>(state_.u.size());
  if (!kind_->rules.controlled) return;
  for (auto& saved : saved_) saved = std::make_unique<TreeState<T>>(state_.topology, state_.lanes);
  mark_ = layouts::AlignedBuffer<double>(state_.x.size());
}

template <class T>
Slot TreeSolver<T>::node_slot(std::uint32_t node, std::uint32_t lane) const {
  if (!line_) return node * state_.lanes + lane;
  return line_->segments.entry(node) * state_.lanes + line_->segments.lane(node);
}

template <class T>
Slot TreeSolver<T>::tie_slot(std::uint32_t tie, std::uint32_t lane) const {
  return ties_begin_ + tie * state_.lanes + lane;
}

template <class T>
auto TreeSolver<T>::place_of(Slot slot) const -> Entry {
  const Slot at = is_tie(slot) ? slot - ties_begin_ : slot;
  return {at / state_.lanes, at % state_.lanes};
}

// --- Steps

template <class T>
void TreeSolver<T>::begin_piece(std::uint32_t, unsigned part) {
  velocities_known_ = false;
  if (state_.laws.pulls) begin_pulls(state_);
  for (TreeGrab& grab : state_.grabs.all) grab.begin_step();
  if (anchors_changed_ || lengths_changed_) take_blow(part);
  if (state_.laws.moves && state_.laws.pulls) keep_blows();
}

template <class T>
double TreeSolver<T>::advance_one(double h, unsigned part, Tally& report) {
  auto& crew = kind_->crews[part];
  if (line_) {
    LoneTree<T> whole(line_->whole);
    return kind_->stepper.advance(line_->segments, state_, h, {line_->work, whole, crew.work, &crew.elastic},
                                  report);
  }
  const TreeStepper<T>& stepper = is_calm_ ? *kind_->calm_stepper : kind_->stepper;
  return stepper.advance(state_, h, crew.view(), report);
}

template <class T>
double TreeSolver<T>::advance(std::uint32_t, double h, std::uint32_t count, unsigned part, Tally& report) {
  double error = 0;
  for (std::uint32_t i = 0; i < count; ++i) error = std::max(error, advance_one(h, part, report));
  return error;
}

// --- Accuracy

template <class T>
ErrorModel TreeSolver<T>::error_model() const {
  const auto& rules = kind_->rules;
  return {.order = rules.gradient == Gradient::new_ ? 1u
                   : state_.grabs.any()             ? 2u
                                                    : rules.time_order,
          .by_comparison = !kind_->estimates(),
          .most_substeps = most_substeps<T>,
          .fallback_is_final = true};
}

template <class T>
bool TreeSolver<T>::starts_anew(std::uint32_t) const {
  if (anchors_changed(0)) return true;
  for (std::uint32_t lane = 0; lane < state_.lanes; ++lane)
    if (!state_.idle[lane] && state_.u_step[lane] == 0) return true;
  return false;
}

template <class T>
void TreeSolver<T>::save(std::uint32_t, Saved which) {
  saved_[static_cast<int>(which)]->copy_motion(state_);
}

template <class T>
void TreeSolver<T>::restore(std::uint32_t, Saved which) {
  state_.copy_motion(*saved_[static_cast<int>(which)]);
}

template <class T>
void TreeSolver<T>::mark(std::uint32_t) {
  std::copy_n(state_.x.data(), mark_.size(), mark_.data());
}

template <class T>
double TreeSolver<T>::distance_from_mark(std::uint32_t) const {
  return largest_distance({state_.x.data(), state_.x.size()}, {mark_.data(), mark_.size()},
                          state_.topology->nodes, state_.lanes);
}

// Gradient old has to resolve the fastest wave, even of a load that hangs still. Mid need not, but it keeps
// what long steps do to fast motion, and would have to follow that ever more closely later. So mid takes
// steps that its own estimate finds short enough as they are, and old takes all that must be cut.

template <class T>
bool TreeSolver<T>::try_calm_step(std::uint32_t, double h, std::uint32_t count, double allowed, unsigned part,
                                  Tally& report) {
  if (!is_calm_) return false;
  Tally attempt = report.begin_try();
  if (advance(0, h, count, part, attempt) <= h * allowed) {
    report.keep(attempt);
    return true;
  }
  restore(0, Saved::step);
  report.take_back(attempt);
  ++report.repeated_steps;
  is_calm_ = false;
  calm_steps_ = 0;
  return false;
}

/// Finds whether gradient mid would do with substeps of `longest`. The error of a substep grows by the third
/// power of its length. The first two substeps of mid have no estimate of their own yet.
template <class T>
void TreeSolver<T>::end_controlled_step(std::uint32_t, double error, double h, double longest, double allowed,
                                        unsigned part) {
  if (anchors_changed(0)) std::fill(state_.known.begin(), state_.known.end(), std::uint8_t{0});
  if (!kind_->calm_stepper || line_) return;
  const double rate = error * longest * longest / (h * h * h * allowed);
  const bool is_line = TreeStepper<T>::is_line(state_, Gradient::old);
  const bool is_dear = cuts(0, longest) >= (is_line ? dear_on_lines : dear_on_trees);
  calm_steps_ = is_dear && rate < calm_rate ? calm_steps_ + 1 : 0;
  if (calm_steps_ < calm_after) return;
  is_calm_ = true;
  TreeWorkspace<T>& work = kind_->crews[part].work;
  kind_->stepper.find_velocities(state_, work);
  if (state_.laws.pulls) count_pulls_ahead(state_, kind_->rules.drag, work);
  for (std::uint32_t lane = 0; lane < state_.lanes; ++lane) state_.restart(lane, work.velocity);
}

// --- Sleep

template <class T>
bool TreeSolver<T>::is_slower(std::uint32_t, double speed) const {
  for (std::uint32_t lane = 0; lane < state_.lanes; ++lane) {
    if (state_.idle[lane]) continue;
    const double step = state_.u_step[lane];
    const T most = static_cast<T>(speed * (step != 0 ? step : 1));
    // The tips come first, which move most.
    for (std::size_t i = state_.u.size() - state_.lanes + lane; i < state_.u.size(); i -= state_.lanes)
      if (!(std::abs(state_.u[i]) <= most)) return false;
  }
  return true;
}

template <class T>
void TreeSolver<T>::rest(std::uint32_t) {
  std::fill_n(velocity_.data(), velocity_.size(), T(0));
  for (std::uint32_t lane = 0; lane < state_.lanes; ++lane) state_.set_velocities(lane, velocity_);
  velocities_known_ = true;
}

template <class T>
double TreeSolver<T>::size(std::uint32_t) const {
  double square = 0;
  for (const double each : state_.scale2) square = std::max(square, each);
  return std::sqrt(square);
}

// --- Particles

template <class T>
Vec3 TreeSolver<T>::position(Slot slot) const {
  const Entry place = place_of(slot);
  if (!is_tie(slot)) return state_.position(place.node, place.lane);
  return state_.read(state_.tie_x, 3 * std::size_t{place.node}, place.lane);
}

template <class T>
Vec3 TreeSolver<T>::velocity(Slot slot) const {
  if (is_tie(slot)) return {};
  find_velocities();
  const Entry place = place_of(slot);
  return state_.read(velocity_, 3 * std::size_t{place.node}, place.lane);
}

template <class T>
void TreeSolver<T>::add_to_hash(Slot slot, StateHash& hash) const {
  hash.add<double>(position(slot));
  if (is_tie(slot)) return;
  const Entry place = place_of(slot);
  for (std::uint32_t c = 0; c < 3; ++c)
    hash.add(static_cast<double>(state_.u[state_.at(3 * place.node + c, place.lane)]));
}

template <class T>
void TreeSolver<T>::find_velocities(TreeWorkspace<T>& work) const {
  if (line_) {
    line_->segments.gather(state_, line_->whole);
    kind_->stepper.find_velocities(line_->whole, work);
    line_->segments.scatter_nodes(work.velocity, velocity_);
  } else {
    kind_->stepper.find_velocities(state_, work);
    std::copy_n(work.velocity.data(), velocity_.size(), velocity_.data());
  }
  velocities_known_ = true;
}

template <class T>
void TreeSolver<T>::find_velocities() const {
  if (!velocities_known_) find_velocities(kind_->crews[0].work);
}

/// A displacement stands for the velocity of now under the force that made it. Before that force changes, it
/// gives way to the velocity, in all lanes of a line in segments. While others move the lane's island, it
/// stands for nothing.
template <class T>
void TreeSolver<T>::keep_velocities(std::uint32_t lane) {
  if (state_.u_step[lane] == 0 || away_ || state_.idle[lane]) return;
  find_velocities();
  for (std::uint32_t l = line_ ? 0 : lane; l < (line_ ? state_.lanes : lane + 1); ++l)
    state_.set_velocities(l, velocity_);
}

template <class T>
double TreeSolver<T>::read(std::span<const Slot> slots, std::span<Vec3> out) const {
  double most = 0;  // it is the largest square of a speed
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const Entry place = place_of(slots[i]);
    const std::size_t at = state_.at(3 * place.node, place.lane), lanes = state_.lanes;
    out[i] = {state_.x[at], state_.x[at + lanes], state_.x[at + 2 * lanes]};
    const double step = state_.u_step[place.lane], over = step != 0 ? 1 / step : 1;
    const Vec3 v =
        over * Vec3{double{state_.u[at]}, double{state_.u[at + lanes]}, double{state_.u[at + 2 * lanes]}};
    most = std::max(most, dot(v, v));
  }
  return std::sqrt(most);
}

template <class T>
void TreeSolver<T>::set_force(Slot slot, Vec3 newton) {
  const Entry place = place_of(slot);
  if (kind_->rules.gradient == Gradient::old) keep_velocities(place.lane);
  state_.set_force(place.node, place.lane, newton);
}

template <class T>
void TreeSolver<T>::set_motion(Slot slot, Vec3 position, Vec3 velocity) {
  const Entry place = place_of(slot);
  const double x[3] = {position.x, position.y, position.z}, v[3] = {velocity.x, velocity.y, velocity.z};
  for (std::uint32_t l = line_ ? 0 : place.lane; l < (line_ ? state_.lanes : place.lane + 1); ++l)
    if (state_.u_step[l] != 0 || state_.known[l] != 0 || state_.mu_kick[l] != 0) {
      state_.restart(l, velocity_);
      state_.mu_kick[l] = state_.mu_kick_before[l] = 0;
    }
  for (std::uint32_t c = 0; c < 3; ++c) {
    const std::size_t at = state_.at(3 * place.node + c, place.lane);
    state_.x[at] = x[c];
    state_.u[at] = velocity_[at] = static_cast<T>(v[c]);
  }
}

template <class T>
void TreeSolver<T>::set_away(Slot slot, bool away) {
  if (line_)
    away_ = away;
  else
    state_.set_idle(place_of(slot).lane, away);
}

// --- Anchors

template <class T>
void TreeSolver<T>::move_anchor(Slot slot, const AnchorMove& move) {
  const Entry place = place_of(slot);
  state_.tie_velocity[state_.at(place.node, place.lane)] = move.velocity();
  state_.ties_move = true;
}

template <class T>
void TreeSolver<T>::begin_anchors() {
  anchors_changed_ =
      state_.ties_move && !std::equal(state_.tie_last_velocity.begin(), state_.tie_last_velocity.end(),
                                      state_.tie_velocity.begin(), std::not_fn(velocity_changes));
}

template <class T>
void TreeSolver<T>::end_anchors() {
  anchors_changed_ = false;
  if (!state_.ties_move) return;
  state_.ties_move =
      std::any_of(state_.tie_velocity.begin(), state_.tie_velocity.end(), [](Vec3 v) { return v != Vec3{}; });
  state_.tie_last_velocity = state_.tie_velocity;
  std::fill(state_.tie_velocity.begin(), state_.tie_velocity.end(), Vec3{});
  std::fill_n(state_.tie_delta.data(), state_.tie_delta.size(), T(0));
  std::fill_n(state_.tie_u.data(), state_.tie_u.size(), T(0));
}

template <class T>
void TreeSolver<T>::place_anchor(Slot slot, Vec3 target) {
  const Entry place = place_of(slot);
  const double at[3] = {target.x, target.y, target.z};
  for (std::uint32_t c = 0; c < 3; ++c) state_.tie_x[state_.at(3 * place.node + c, place.lane)] = at[c];
  velocities_known_ = false;  // or a restored world would find others, from where the anchor is now
}

// --- Reports

template <class T>
void TreeSolver<T>::describe(WorldInfo& info) const {
  const TreeTopology& tree = line_ ? *line_->whole.topology : *state_.topology;
  info.direct_rods += (line_ ? 1 : state_.trees) * tree.rods();
  info.changes_gradient = info.changes_gradient || (kind_->calm_stepper && !line_);
}

template class TreeSolver<float>;
template class TreeSolver<double>;

}  // namespace plumb::detail
