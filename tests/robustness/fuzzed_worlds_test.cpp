// Worlds that the fuzzer found: every step must end finite, within the work that the settings allow.

#include <gtest/gtest.h>

#include <string_view>

#include "plumb/plumb.hpp"
#include "scenes/files/scene_file.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// Steps a scene and expects a finite state after every step. No step may do more than a tenth above its
/// most work: what comes after it is the few substeps that are named, each tried a few times.
void expect_good_end(const Scene& scene, const Settings& settings, double dt, int steps) {
  World world(scene, settings);
  for (int step = 0; step < steps; ++step) {
    if (step == 1) world.set_force(0, {-1, -1, -1});
    const StepReport report = world.step(dt);
    const std::uint64_t work = report.newton + report.block_sweeps + report.direct_substeps + report.halvings;
    EXPECT_LT(work, 1.1 * static_cast<double>(settings.most_work * world.info().islands)) << step;
    for (std::uint32_t i = 0; i < world.particle_count(); ++i) {
      EXPECT_TRUE(is_finite(world.position(i))) << "particle " << i << " after step " << step;
      EXPECT_TRUE(is_finite(world.velocity(i))) << "particle " << i << " after step " << step;
    }
  }
}

// The length of a substep in float would be 0, and a displacement divided by it is not a number.
TEST(FuzzedWorlds, RefuseAStepOfNoLengthInFloat) {
  Scene scene;
  scene.particles.push_back({.position = {-1, -1, -1}, .velocity = {}, .mass = 0.01});
  for (const Method method : {Method::relax, Method::direct}) {
    World world(scene, {.method = method, .precision = Precision::single, .threads = 1});
    EXPECT_THROW(world.step(1e-300), InputError);
  }
}

// A ball a metre deep in the ground, and in a box: no step is accurate, whatever its substeps.
TEST(FuzzedWorlds, StartInTheGroundWithAnAccuracy) {
  Scene scene;
  scene.particles.push_back({.position = {-0.5, -1, -0.5}, .velocity = {-0.5, -0.5, -0.5}, .mass = 9.6});
  scene.capsules.push_back(
      {.a = point_at(0), .b = point_at(0), .radius = 0.19, .surface = {.friction = 0.24}});
  scene.planes.push_back({.offset = -0.008, .surface = {.friction = 1.4, .restitution = 0.28}});
  scene.boxes.push_back(
      {.center = {-1, -0.25, -0.25}, .half_size = {0.5, 0.2, 0.3}, .surface = {.friction = 1.5}});
  expect_good_end(scene, {.method = Method::automatic, .accuracy = 1e-2, .threads = 1}, 0.05, 5);
}

// A block deep in the ground and in a box, with a capsule to a particle far away, cannot be solved either.
TEST(FuzzedWorlds, StartInTheGroundAndInABox) {
  constexpr std::string_view json = R"({
  "plumb": 1,
  "particles": [
    {"position":[-0.75,1.0,0.5],"mass":0.01},
    {"position":[-0.6633974596215562,-0.6922649730810374,-0.2211324865405187]},
    {"position":[-0.8366025403784438,-0.8077350269189626,-0.2211324865405187]},
    {"position":[-0.8366025403784438,-0.6922649730810374,-0.2788675134594813]},
    {"position":[-0.6633974596215562,-0.8077350269189626,-0.2788675134594813]}
  ],
  "rods": [
    {"a":1,"b":2,"length":0.20816659994661324}, {"a":1,"b":3,"length":0.18257418583505533},
    {"a":2,"b":3,"length":0.1290994448735806}, {"a":1,"b":4,"length":0.1290994448735806},
    {"a":2,"b":4,"length":0.18257418583505533}, {"a":3,"b":4,"length":0.20816659994661324}
  ],
  "bodies": [
    {"particles":[1,2,3,4],"mass":3.667685969329366,"center":[-0.75,-0.75,-0.25],
     "inertia":{"xx":0.015282024872205695,"yy":0.030564049744411386,"zz":0.0397332646677348}}
  ],
  "capsules": [
    {"a":0,"b":{"particles":[2,4],"weights":[0.6686274509803921,0.3313725490196079]},"radius":0.08313725490196079,
     "friction":0.6235294117647059,"restitution":0.41568627450980394},
    {"a":1,"b":3,"radius":0.02520790417334249,"friction":0.00022888532845044633},
    {"a":4,"b":{"particles":[1,3],"weights":[-0.3683451590753033,1.3683451590753033]},"radius":0.0960952162966354,
     "friction":0.2997482261387045,"restitution":1.0}
  ],
  "planes": [{"normal":[0.0,1.0,0.0],"friction":1.5,"restitution":1.0}],
  "boxes": [{"center":[-0.25,-0.25,-0.5],"half_size":[0.5,0.2,0.3],"friction":0.0}]
})";
  const Scene scene = scenes::parse_scene(json, "fuzzed");
  expect_good_end(scene, {.method = Method::automatic, .substeps = 4, .sleep = false, .threads = 1}, 1.0 / 60,
                  5);
}

// A capsule passes another one, and nothing was near when the substep began: the first contact that asks what
// held it in the last substep is one that was missed.
TEST(FuzzedWorlds, PassWhereNothingWasNear) {
  constexpr std::string_view json = R"({
  "plumb": 1,
  "particles": [
    {"position":[-0.5,-0.5,-0.5],"mass":7.615113298237583,"fixed":true},
    {"position":[1.0,1.0,0.25],"mass":1.0},
    {"position":[-0.5,0.25,0.25],"mass":0.6356040283817808,"velocity":[0.75,-0.25,1.0]},
    {"position":[-1.0,0.25,-0.5],"mass":4.548982833600366},
    {"position":[0.03237964446478969,0.0,-0.75],"mass":1.9281226825360493},
    {"position":[-1.0,-0.25,-0.8064393072404059],"mass":1.0,"fixed":true},
    {"position":[-0.75,1.0,-0.5],"mass":3.497163195239185,"fixed":true},
    {"position":[-0.75,0.5,0.0],"mass":3.5308519111924923,"fixed":true},
    {"position":[0.5,-0.75,-0.25],"mass":4.947454795147632,"fixed":true,"asleep":true},
    {"position":[0.75,-0.25,-1.0],"mass":3.0840572213321122,"fixed":true},
    {"position":[1.305897611963073,-1.0,0.75],"mass":3.5288702220187687},
    {"position":[-0.16339745962155616,0.3077350269189626,-0.4711324865405187],"mass":1.0},
    {"position":[-0.33660254037844384,0.19226497308103743,-0.4711324865405187],"mass":1.0},
    {"position":[-0.33660254037844384,0.3077350269189626,-0.5288675134594812],"mass":1.0},
    {"position":[-0.16339745962155616,0.19226497308103743,-0.5288675134594812],"mass":1.0}
  ],
  "rods": [
    {"a":10,"b":5,"length":0.7733623254749371,"strength":82.0},
    {"a":10,"b":0}
  ],
  "angles": [
    {"u":{"from":{"particles":[10,0],"weights":[0.3166018158236057,0.6833981841763943]},
          "to":5},
     "v":{"from":{"particles":[0,2],"weights":[0.347302967879759,0.652697032120241]},"to":7},
     "lower":1.2463721675440604,
     "upper":2.6283863584344243,
     "friction":0.13443198290989547,
     "stiffness":26.330968184939344,
     "damping":8.706797894254978}
  ],
  "capsules": [
    {"a":10,
     "b":14,
     "radius":0.11295643549248494,
     "friction":0.4514305333028153,
     "restitution":0.22754253452353704,
     "own_island":true},
    {"a":{"particles":[2,3],"weights":[0.2715877012283512,0.7284122987716488]},
     "b":6,
     "radius":0.1651575494010834,
     "friction":0.07663080796520944,
     "restitution":0.3265735866330968,
     "own_island":true}
  ]
})";
  const Scene scene = scenes::parse_scene(json, "fuzzed");
  World world(scene, {.method = Method::relax, .substeps = 2, .threads = 1});
  for (int step = 0; step < 15; ++step) {
    world.step(1.0 / 60);
    for (std::uint32_t i = 0; i < world.particle_count(); ++i)
      EXPECT_TRUE(is_finite(world.position(i))) << "particle " << i << " after step " << step;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
