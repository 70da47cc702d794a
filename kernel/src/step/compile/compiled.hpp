#pragma once

#include <memory>

#include "contact/contact_solver.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"
#include "step/inputs/cords.hpp"
#include "step/places.hpp"

namespace plumb::detail {

/// Holds a scene ready for stepping: the solvers of its islands, and where every particle is.
struct Compiled {
  Array<std::unique_ptr<Solver>> solvers;
  Places places;
  CordPlaces cords;                  ///< where cords are that can be asked how they pull
  Places twists;                     ///< where twists are
  ContactSolver* contact = nullptr;  ///< one of the solvers, if anything may touch or has joints
  std::shared_ptr<TreeKinds> kinds;  ///< of trees that are solved directly
  bool needs_contact = false;        ///< An addition has islands that the contact solver is to know.
  WorldInfo info;
};

/// Cuts a valid scene into islands, chooses what moves each, and makes the solvers. Settings::threads must be
/// the number of threads that steps will have.
Compiled compile(const std::shared_ptr<const Scene>& scene, const Settings& settings);

/// Does so with islands of rods and elements that were part of a scene compiled before. What refuses a scene
/// was asked then. Solvers are not started: set_motion() hands them how islands move.
Compiled compile_parts(const Scene& parts, const Settings& settings, const Compiled& whole);

/// Does so with islands that are added to a scene compiled before, which have no twists nor reels. Solvers
/// are started as those of a scene, and what those refuse is refused. Those that only the contact solver can
/// move are left to it.
Compiled compile_addition(const Scene& addition, const Settings& settings, const Compiled& whole);

}  // namespace plumb::detail
