// This file puts trees where their rods fit as a world starts.

#include <algorithm>

#include "direct/loops/settle.hpp"
#include "direct/trees/tree_solver.hpp"

namespace plumb::detail {

template <class T>
std::uint32_t TreeSolver<T>::project_positions() {
  const TreeStepper<T> stepper(Gradient::new_, 0, false, kind_->rules.isa);
  TreeState<T>& state = line_ ? line_->whole : state_;
  TreeState<T> before(state.topology, state.lanes);
  before.copy_motion(state);
  auto& crew = kind_->crews[0];
  LoneTree<T> alone(kind_->topology);
  Tally tried;
  stepper.advance(state, projection_step, {crew.work, alone, crew.alone_work()}, tried);
  if (tried.unsolved == 0) std::copy_n(state.x.data(), state.x.size(), before.x.data());
  state.copy_motion(before);  // all but x goes back
  const std::uint32_t unsettled = tried.unsolved == 0 ? 0 : crew.elastic.settle(state, alone.get());
  if (line_) line_->segments.scatter(state, state_);
  return unsettled;
}

template <class T>
void TreeSolver<T>::set_velocity(Slot slot, Vec3 velocity) {
  const Entry place = place_of(slot);
  const double v[3] = {velocity.x, velocity.y, velocity.z};
  for (std::uint32_t c = 0; c < 3; ++c)
    state_.u[state_.at(3 * place.node + c, place.lane)] = static_cast<T>(v[c]);
}

template <class T>
void TreeSolver<T>::project_velocities() {
  TreeWorkspace<T>& work = kind_->crews[0].work;
  velocities_known_ = false;
  if (!line_) return kind_->stepper.project_velocities(state_, work);
  line_->segments.gather(state_, line_->whole);
  kind_->stepper.project_velocities(line_->whole, work);
  line_->segments.scatter(line_->whole, state_);
}

template std::uint32_t TreeSolver<float>::project_positions();
template void TreeSolver<float>::set_velocity(Slot, Vec3);
template void TreeSolver<float>::project_velocities();
template std::uint32_t TreeSolver<double>::project_positions();
template void TreeSolver<double>::set_velocity(Slot, Vec3);
template void TreeSolver<double>::project_velocities();

}  // namespace plumb::detail
