#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace plumb::detail {

/// Lists what a program ordered between two steps that makes islands anew. Of several orders for a particle
/// the last holds.
struct Edits {
  std::vector<std::uint32_t> cut;                        ///< rods
  std::vector<std::pair<std::uint32_t, double>> masses;  ///< particles, and their own masses in kg
  std::vector<std::pair<std::uint32_t, bool>> fixed;     ///< particles, and whether they are fixed now

  bool any() const { return !cut.empty() || !masses.empty() || !fixed.empty(); }
  friend bool operator==(const Edits&, const Edits&) = default;
};
template <class Archive>
void visit_members(Archive& archive, Edits& of) {
  auto& [cut, masses, fixed] = of;
  archive(cut, masses, fixed);
}

}  // namespace plumb::detail
