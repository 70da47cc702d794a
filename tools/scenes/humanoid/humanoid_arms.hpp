#pragma once

#include "scenes/humanoid/humanoid.hpp"

namespace plumb::scenes {

/// A fuller figure than the thesis's: its section 4.5.2 says that arms could not be placed on the sides of
/// the upper torso, and that its knees bend both ways. Here limbs but neck and spine, which are rods, are
/// bodies with the full inertia of solid cylinders, jointed wherever joints are: hips beside each other on
/// the basin, shoulders on the sides of the upper torso, knees and elbows that are hinges and bend one way,
/// by at most 140 degrees. Lengths, masses and radii are the thesis's (its legs straight down, apart by 10
/// degrees); arms are of 20 inches each half, 0.8 times the radius of the legs, and of the masses that
/// Winter's table has in proportion to the thigh's (10 % of a body): upper arm 2.8 %, forearm and hand 2.2 %.
/// Stands as the other does: front towards +x, asleep, feet on y = 0.
Scene make_humanoid_with_arms(const HumanoidShape& shape);

/// m, of that figure.
Vec3 torso_center_with_arms(const HumanoidShape& shape);

}  // namespace plumb::scenes
