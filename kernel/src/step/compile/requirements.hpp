#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "step/methods.hpp"

namespace plumb::detail {

/// Names the methods of this program for which `can` holds, as a sentence does: "relax, direct and auto".
std::string methods_that(const std::function<bool(const MethodRow&)>& can);

/// Refuses springs and torsions where the method does not know them.
void require_springs_moved(const Scene& scene, Method method);
/// Refuses rods that give where the method or its time order moves rigid ones alone.
void require_laws_moved(const Scene& scene, const Settings& settings);
/// Refuses element `i` of a kind where the method or the gradient does not know it. `why` says what gradient
/// old lacks.
void require_element_moved(const Settings& settings, const char* kind, std::size_t i, const char* why);
/// Refuses an island with joints, as a scene of its own, that the settings cannot move. `particles` are its
/// numbers in the scene. The message names what the island has, and the methods that move it.
void require_joints_moved(const Scene& island, std::span<const std::uint32_t> particles,
                          const Settings& settings);

/// Refuses settings of relaxation where method automatic solves all islands. `touches` says whether they may
/// touch.
void require_read_by_direct(const Settings& settings, bool touches);
/// Refuses a tolerance that no solver reads.
void require_tolerance_read(const Settings& settings);

}  // namespace plumb::detail
