#include "direct/trees/tree_kind.hpp"

#include <utility>

#include "interface/state_hash.hpp"

namespace plumb::detail {
namespace {

/// So many trees are remembered, of islands of no more vertices than this: less than 1 MB.
constexpr std::size_t most_trees = 64, most_vertices = 256;

std::uint64_t hash_of(const layouts::LocalGraph& island) {
  std::uint64_t hash = island.movable.size();
  for (const auto [a, b] : island.edges) hash = (hash ^ (std::uint64_t{a} << 32 | b)) * 0x9e3779b97f4a7c15u;
  return hash;
}

std::shared_ptr<const layouts::Tree> find_tree(const layouts::LocalGraph& island) {
  auto tree = layouts::find_tree(island.view());
  return tree ? std::make_shared<const layouts::Tree>(std::move(*tree)) : nullptr;
}

std::uint64_t hash_of(const layouts::Tree& tree) {
  StateHash hash;
  for (const std::uint32_t each : tree.parent) hash.add(each);
  for (const std::uint32_t each : tree.tie_begin) hash.add(each);
  return hash.value();
}

template <class T>
bool is_of(const TreeKind<T>& kind, const layouts::Tree& tree, std::uint32_t lanes,
           const typename TreeKind<T>::Rules& rules, const LineBends& bends) {
  const TreeTopology& topology = *kind.topology;
  return kind.lanes == lanes && kind.rules == rules && topology.parent == tree.parent &&
         topology.tie_begin == tree.tie_begin && topology.bends == bends;
}

}  // namespace

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
    crews.push_back({TreeWorkspace<T>(*topology, lanes),
                     ElasticTree<T>(topology, rules.gradient, rules.drag, rules.isa), LoneTree<T>(topology),
                     lanes == 1 ? nullptr : std::make_unique<TreeWorkspace<T>>(*topology, 1)});
  for (auto& crew : crews)
    if (bounded) crew.elastic.bound_frames();
}

std::shared_ptr<const layouts::Tree> TreeKinds::tree_of(const layouts::LocalGraph& island) {
  if (island.movable.size() > most_vertices) return find_tree(island);
  const std::uint64_t hash = hash_of(island);
  for (auto [each, end] = trees_.equal_range(hash); each != end; ++each)
    if (each->second.island == island) return each->second.tree;
  if (trees_.size() >= most_trees) trees_.clear();
  return trees_.emplace(hash, KnownTree{island, find_tree(island)})->second.tree;
}

template <class T>
std::shared_ptr<TreeKind<T>> TreeKinds::get(const layouts::Tree& tree, std::uint32_t lanes,
                                            const typename TreeKind<T>::Rules& rules,
                                            const LineBends& bends) {
  auto& [kinds, full] = std::get<Known<T>>(known_);
  const std::uint64_t hash = hash_of(tree);
  for (auto [each, end] = kinds.equal_range(hash); each != end; ++each)
    if (auto kind = each->second.lock(); kind && is_of(*kind, tree, lanes, rules, bends)) return kind;
  if (kinds.size() >= full) {
    std::erase_if(kinds, [](const auto& each) { return each.second.expired(); });
    full = 2 * kinds.size() + 16;
  }
  auto made = std::make_shared<TreeKind<T>>(tree, lanes, rules, bends);
  kinds.emplace(hash, made);
  return made;
}

template struct TreeKind<float>;
template struct TreeKind<double>;
template std::shared_ptr<TreeKind<float>> TreeKinds::get(const layouts::Tree&, std::uint32_t,
                                                         const TreeKind<float>::Rules&, const LineBends&);
template std::shared_ptr<TreeKind<double>> TreeKinds::get(const layouts::Tree&, std::uint32_t,
                                                          const TreeKind<double>::Rules&, const LineBends&);

}  // namespace plumb::detail
