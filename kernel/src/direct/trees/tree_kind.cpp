#include "direct/trees/tree_kind.hpp"

#include <utility>

namespace plumb::detail {

template <class T>
TreeKind<T>::TreeKind(const layouts::Tree& tree, std::uint32_t width, const Rules& of, LineBends bends)
    : rules(of),
      topology(std::make_shared<const TreeTopology>(tree, std::move(bends))),
      lanes(width),
      stepper(of.gradient, of.drag, estimates(), of.isa, of.time_order) {
  const bool bounded = rules.bounds_frames && topology->ties > 1;
  if (bounded) stepper.bound_frames();
  if (rules.changes_gradient) calm_stepper.emplace(Gradient::mid, rules.drag, true, rules.isa);
  for (unsigned part = 0; part < rules.threads; ++part)
    crews.push_back({TreeWorkspace<T>(*topology, lanes), TreeState<T>(topology, 1),
                     TreeWorkspace<T>(*topology, 1),
                     ElasticTree<T>(topology, rules.gradient, rules.drag, rules.isa)});
  for (auto& crew : crews)
    if (bounded) crew.elastic.bound_frames();
}

template struct TreeKind<float>;
template struct TreeKind<double>;

}  // namespace plumb::detail
