#include "direct/bends/line_bends.hpp"

#include <algorithm>

namespace plumb::detail {
namespace {

constexpr std::uint32_t none = simd::no_slot;

/// Finds slots of bends, one bend after the other, and then those of a twist.
class Finder {
 public:
  explicit Finder(const layouts::Tree& tree) : tree_(tree), nodes_(tree.nodes()) {
    const std::uint32_t last = tree.tie_begin[nodes_ - 1];
    if (tree.tie_begin[1] > 0) out_.ends[1] = 0;
    if (last < tree.ties.size()) out_.ends[2] = last;
    for (std::uint32_t i = 0; i < nodes_; ++i)
      node_of_.resize(std::max<std::size_t>(node_of_.size(), tree.vertex[i] + 1), none);
    for (std::uint32_t i = 0; i < nodes_; ++i) node_of_[tree.vertex[i]] = i;
    taken_.assign(nodes_ + 2, 0);
  }

  /// Says whether there is a slot for a bend, which it then takes.
  bool add(const LoopBend& bend) {
    const auto [a, b, c] = bend.vertices;
    return !is_node(b) ? add_clamped(a, b, c, false) || add_clamped(c, b, a, true)
                       : add_at(node_of_[b], a, c);
  }
  /// Says whether a chain goes along the line, which then has its twist.
  bool add(const LoopTwist& twist) {
    const auto& chain = twist.vertices;
    if (twist.is_ring()) return false;
    const auto first = std::find_if(chain.begin(), chain.end(), [&](std::uint32_t i) { return is_node(i); });
    if (first == chain.end()) return false;
    const std::int64_t node = node_of_[*first], before = first - chain.begin();
    for (const std::int64_t direction : {1, -1}) {
      const std::int64_t begin = node - direction * before;
      if (goes_along(chain, begin, direction)) {
        clamp(chain, begin, direction);
        return true;
      }
    }
    return false;
  }
  LineBends take() { return std::move(out_); }

 private:
  bool is_node(std::uint32_t vertex) const { return vertex < node_of_.size() && node_of_[vertex] != none; }
  /// Returns the vertex at a place, or none.
  std::uint32_t vertex(std::int64_t place) const {
    if (place >= 0 && place < nodes_) return tree_.vertex[static_cast<std::size_t>(place)];
    const std::uint32_t tie = out_.end(place, nodes_);
    return tie == none ? none : tree_.ties[tie].vertex;
  }
  bool take(std::int64_t slot, bool turned) {
    std::uint8_t& taken = taken_[static_cast<std::size_t>(slot)];
    if (taken != 0) return false;
    taken = 1;
    out_.slots.push_back(static_cast<std::uint32_t>(slot));
    out_.turned.push_back(turned ? 1 : 0);
    return true;
  }
  bool add_at(std::int64_t middle, std::uint32_t a, std::uint32_t c) {
    const std::uint32_t before = vertex(middle - 1), after = vertex(middle + 1);
    if (before == none || after == none) return false;
    if (a == before && c == after) return take(middle + 1, false);
    return a == after && c == before && take(middle + 1, true);
  }
  /// `a` is beyond the anchor `b`, and `c` is an end of the line.
  bool add_clamped(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool turned) {
    if (is_node(a)) return false;
    for (const bool at_tip : {false, true}) {
      const std::int64_t end = at_tip ? nodes_ - 1 : 0, anchor = at_tip ? nodes_ : -1;
      if (vertex(end) != c || vertex(anchor) != b) continue;
      if (!take(at_tip ? nodes_ + 1 : 0, at_tip != turned)) return false;
      add_clamp(at_tip, a);
      return true;
    }
    return false;
  }
  void add_clamp(bool at_tip, std::uint32_t vertex) {
    out_.ends[at_tip ? 3 : 0] = static_cast<std::uint32_t>(tree_.ties.size() + out_.clamps.size());
    out_.clamps.push_back(vertex);
  }
  /// Says whether a chain's vertices are at the places from `begin` on. A clamp may be where none is yet.
  bool goes_along(const Array<std::uint32_t>& chain, std::int64_t begin, std::int64_t direction) const {
    for (const std::uint32_t vertex_of_chain : chain) {
      const bool is_clamp = begin == -2 || begin == nodes_ + 1;
      if (begin < -2 || begin > nodes_ + 1) return false;
      if (is_clamp && (is_node(vertex_of_chain) || vertex(begin == -2 ? -1 : nodes_) == none)) return false;
      const std::uint32_t there = is_clamp ? clamp_at(begin) : vertex(begin);
      if (there != vertex_of_chain && !(is_clamp && there == none)) return false;
      begin += direction;
    }
    return true;
  }
  std::uint32_t clamp_at(std::int64_t place) const {
    const std::uint32_t tie = out_.ends[place < 0 ? 0 : 3];
    return tie == none ? none : out_.clamps[tie - tree_.ties.size()];
  }
  /// Makes clamps at the ends of a chain that goes along the line, and says where its joints are.
  void clamp(const Array<std::uint32_t>& chain, std::int64_t begin, std::int64_t direction) {
    const std::int64_t end = begin + direction * (static_cast<std::int64_t>(chain.size()) - 1);
    const std::int64_t low = std::min(begin, end), high = std::max(begin, end);
    if (low == -2 && out_.ends[0] == none) add_clamp(false, begin < end ? chain.front() : chain.back());
    if (high == nodes_ + 1 && out_.ends[3] == none)
      add_clamp(true, begin < end ? chain.back() : chain.front());
    out_.twist_begin = static_cast<std::uint32_t>(low + 2);
    out_.twist_end = static_cast<std::uint32_t>(high + 1);
  }

  const layouts::Tree& tree_;
  std::int64_t nodes_;
  Array<std::uint32_t> node_of_;  ///< by vertex
  Array<std::uint8_t> taken_;     ///< by slot
  LineBends out_;
};

bool is_line(const layouts::Tree& tree) {
  const std::uint32_t nodes = tree.nodes();
  if (nodes < 2) return false;
  for (std::uint32_t i = 1; i < nodes; ++i)
    if (tree.parent[i] + 1 != i) return false;
  const auto ties = [&](std::uint32_t i) { return tree.tie_begin[i + 1] - tree.tie_begin[i]; };
  return ties(0) <= 1 && ties(nodes - 1) <= 1 && ties(0) + ties(nodes - 1) == tree.ties.size();
}

}  // namespace

std::optional<LineBends> find_line_bends(const layouts::Tree& tree, const LoopElements& elements) {
  const bool has_others = !elements.tackles.empty() || elements.twists.size() > 1 || !elements.reels.empty();
  if (has_others || !is_line(tree)) return std::nullopt;
  Finder finder(tree);
  for (const LoopBend& bend : elements.bends)
    if (!finder.add(bend)) return std::nullopt;
  for (const LoopTwist& twist : elements.twists)
    if (!finder.add(twist)) return std::nullopt;
  return finder.take();
}

}  // namespace plumb::detail
