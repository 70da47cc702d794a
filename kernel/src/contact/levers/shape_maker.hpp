#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "contact/linkage/linkage.hpp"

namespace plumb::detail {

/// Makes shapes of the capsules of a part of a scene, and finds what they turn with.
///
/// That is the body that holds both of its ends, or else a rod that keeps two particles apart, of which its
/// places are sums. Rods that may break, and cables, which may be slack, turn nothing. Two anchors do.
class ShapeMaker {
 public:
  /// The part must outlive this object.
  explicit ShapeMaker(const Scene& part);
  /// The shape's places are kept in `places`.
  Linkage::Shape make(const Capsule& capsule, TermPool& places) const;

 private:
  bool keeps_apart(std::uint32_t a, std::uint32_t b) const;

  const Scene& part_;
  std::multimap<std::uint32_t, std::uint32_t> bodies_;            ///< by particle
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> rods_;  ///< by their ends: whether they turn shapes
};

}  // namespace plumb::detail
