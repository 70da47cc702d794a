#pragma once

#include <cmath>
#include <cstddef>

#include "plumb/scene.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {

/// Refuses the law of the rod or tackle that `what` and `i` name.
inline void validate_law(const RodLaw& law, const char* what, std::size_t i) {
  if (!(law.stiffness >= 0)) refuse(what, i, ": stiffness must be 0 or more, got ", law.stiffness, " N/m");
  if (!(law.damping >= 0 && std::isfinite(law.damping)))
    refuse(what, i, ": damping must be finite and not negative, got ", law.damping, " N s/m");
  if (!(law.strength > 0)) refuse(what, i, ": strength must be positive, got ", law.strength, " N");
  if (law.damping > 0 && !law.is_elastic())
    refuse(what, i, ": is rigid, so that it has no damping; give it a stiffness");
  if (law.stiffness == 0 && law.damping == 0)
    refuse(what, i, ": has neither stiffness nor damping, so that it holds nothing");
}

}  // namespace plumb::detail
