#include "truth/spanning_tree.hpp"

#include <numeric>

namespace plumb::truth {
namespace {

/// Tells which particles are connected by the rods joined so far. All fixed ones are.
class Parts {
 public:
  explicit Parts(const Model& model) : model_(model), up_(model.particles() + 1) {
    std::iota(up_.begin(), up_.end(), 0u);
  }

  /// Joins a rod's ends. Returns false if they already were connected.
  bool join(const ModelRod& rod) {
    const std::uint32_t a = top(rod.a), b = top(rod.b);
    up_[a] = b;
    return a != b;
  }

 private:
  std::uint32_t top(std::uint32_t i) {
    if (model_.fixed[i]) i = static_cast<std::uint32_t>(model_.particles());
    while (up_[i] != i) i = up_[i] = up_[up_[i]];
    return i;
  }

  const Model& model_;
  std::vector<std::uint32_t> up_;
};

/// Returns whether a rod's mass ties the accelerations of its ends together.
bool couples(const Model& model, const ModelRod& rod) {
  return rod.coupling != 0 && !model.fixed[rod.a] && !model.fixed[rod.b];
}

/// Walks breadth first from the fixed particles, then from the first particle of each part that floats.
std::vector<TreeNode> grow(const Model& model, const std::vector<std::uint32_t>& rods) {
  std::vector<std::vector<std::uint32_t>> rods_at(model.particles());
  for (const std::uint32_t r : rods) {
    rods_at[model.rods[r].a].push_back(r);
    rods_at[model.rods[r].b].push_back(r);
  }
  std::vector<TreeNode> nodes;
  std::vector<char> seen(model.fixed);
  std::size_t next = 0;
  const auto reach_from = [&](std::uint32_t here) {
    for (const std::uint32_t r : rods_at[here]) {
      const ModelRod& rod = model.rods[r];
      const std::uint32_t other = rod.a == here ? rod.b : rod.a;
      if (seen[other]) continue;
      seen[other] = 1;
      nodes.push_back({.particle = other, .parent = here, .rod = r});
    }
  };
  const auto finish = [&] {
    for (; next < nodes.size(); ++next) reach_from(nodes[next].particle);
  };
  for (std::uint32_t i = 0; i < model.particles(); ++i) {
    if (model.fixed[i]) reach_from(i);
  }
  finish();
  for (std::uint32_t i = 0; i < model.particles(); ++i) {
    if (seen[i]) continue;
    seen[i] = 1;
    nodes.push_back({.particle = i});
    finish();
  }
  return nodes;
}

}  // namespace

SpanningTree grow_spanning_tree(const Model& model) {
  std::vector<std::uint32_t> all, wanted, chosen;
  for (std::uint32_t r = 0; r < model.rods.size(); ++r) {
    const bool coupled = couples(model, model.rods[r]);
    if (coupled) wanted.push_back(r);
    if (coupled || !model.rods[r].elastic) all.push_back(r);
  }
  for (const TreeNode& node : grow(model, all)) {
    if (node.rod != no_rod) wanted.push_back(node.rod);
  }
  Parts parts(model);
  std::vector<char> in_tree(model.rods.size(), 0);
  for (const std::uint32_t r : wanted) {
    if (in_tree[r] || !parts.join(model.rods[r])) continue;
    in_tree[r] = 1;
    chosen.push_back(r);
  }
  SpanningTree tree{.nodes = grow(model, chosen), .chords = {}};
  for (const std::uint32_t r : all) {
    if (!in_tree[r]) tree.chords.push_back(r);
  }
  return tree;
}

}  // namespace plumb::truth
