#pragma once

#include "plumb/scene.hpp"

/// Scenes with bodies, joints and contact that scenes.hpp lists. None takes an angle's sine or cosine, whose
/// last bits differ between C libraries.
namespace plumb::golden {

Scene make_tower();
Scene make_slide();
Scene make_rollers();
Scene make_mechanism();
Scene make_springs();
Scene make_pool();
Scene make_draped_rope();
Scene make_hilly();
Scene make_fallen_wire();
Scene make_knot();
Scene make_bridge();

}  // namespace plumb::golden
