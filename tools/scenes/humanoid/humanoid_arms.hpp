#pragma once

#include "scenes/humanoid/humanoid.hpp"

namespace plumb::scenes {

/// Makes a fuller figure than the thesis's. Its section 4.5.2 says that arms could not be placed on the sides
/// of the upper torso, and that its knees bend both ways. Neck and spine are rods, and all other limbs are
/// bodies with the full inertia of solid cylinders. Hips sit beside each other on the basin, and shoulders on
/// the sides of the upper torso. Knees and elbows are hinges that bend one way, by at most 140 degrees.
/// Lengths, masses and radii are the thesis's, with legs straight down and apart by 10 degrees. Either half
/// of an arm is 20 inches long and has 0.8 times the radius of the legs. Masses of arms are in proportion to
/// the thigh's (10 % of a body), as in Winter's table: upper arm 2.8 %, forearm and hand 2.2 %. It stands as
/// the other does: front towards +x, asleep, feet on y = 0.
Scene make_humanoid_with_arms(const HumanoidShape& shape);

/// Returns the height of that figure, in m.
Vec3 torso_center_with_arms(const HumanoidShape& shape);

}  // namespace plumb::scenes
