#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "scene/lists/by_kind.hpp"

namespace plumb::detail {

/// Keeps what a kind of islands is made of, which edits and grabs ask for. What a world began with is named
/// in its scene, which is there anyway; what edits made of it is a scene of its own.
class KeptPart {
 public:
  KeptPart() = default;
  /// Names a part of `whole`, as SceneParts does. `is_lumped` says that its ends have the mass of its rods.
  KeptPart(std::shared_ptr<const Scene> whole, Names names, bool is_lumped)
      : whole_(std::move(whole)), names_(std::move(names)), is_lumped_(is_lumped) {}
  explicit KeptPart(const Scene& part) : whole_(std::make_shared<const Scene>(part)) {}

  /// Makes the part, which takes time by its size.
  Scene scene() const;
  /// Returns a rod by its number in the part; its ends and mass are those of the whole.
  const Rod& rod(std::uint32_t number) const { return whole_->rods[rod_in_whole(number)]; }
  double rod_length(std::uint32_t number) const { return plumb::rod_length(*whole_, rod_in_whole(number)); }
  /// Returns whether a body holds both ends of a rod, or a bend is beside it.
  bool is_of_body(std::uint32_t rod) const;
  bool bends(std::uint32_t rod) const;
  /// Returns whether a part stands alike, to the last bit, wherever it is.
  bool stands_like(const Scene& part) const;

 private:
  std::uint32_t rod_in_whole(std::uint32_t number) const { return names_ ? names_->rods[number] : number; }
  /// Returns whether any of the part's items is as asked.
  template <class Item, class Is>
  bool any(const std::vector<Item>& of_whole, Is&& is) const {
    if (!names_) return std::any_of(of_whole.begin(), of_whole.end(), is);
    const Array<std::uint32_t>& names = *names_->all()[kind_of<Item>()];
    return std::any_of(names.begin(), names.end(), [&](std::uint32_t each) { return is(of_whole[each]); });
  }

  std::shared_ptr<const Scene> whole_;
  std::optional<Names> names_;  ///< None if the part is the whole.
  bool is_lumped_ = false;
};

}  // namespace plumb::detail
