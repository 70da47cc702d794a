#include "scenes/scene_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "plumb/error.hpp"
#include "scenes/files.hpp"
#include "scenes/spec.hpp"

namespace plumb::scenes {
namespace {

std::string message_of(std::string_view json) {
  try {
    parse_scene(json, "f.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A scene file with one part replaced.
std::string with(const std::string& particle, const std::string& rod = R"({"a": 0, "b": 1})",
                 const std::string& top = "") {
  return R"({"plumb": 1, "particles": [{"position": [0, 0, 0], "fixed": true}, )" + particle +
         R"(], "rods": [)" + rod + "]" + top + "}";
}
const std::string sound = R"({"position": [1, 0, 0], "mass": 1})";

TEST(SceneFile, DefaultsAreThoseOfScene) {
  const Scene scene = parse_scene(with(sound), "f.json");
  EXPECT_EQ(scene.gravity, (Vec3{0, -9.81, 0}));
  EXPECT_EQ(scene.drag, 0);
  ASSERT_EQ(scene.particles.size(), 2u);
  EXPECT_TRUE(scene.particles[0].fixed);
  EXPECT_EQ(scene.particles[1].velocity, Vec3{});
  ASSERT_EQ(scene.rods.size(), 1u);
  EXPECT_EQ(scene.rods[0].mass, 0);
  EXPECT_EQ(rod_length(scene, 0), 1);
}

TEST(SceneFile, RoundTripKeepsEveryBit) {
  Scene scene = load_scene("graph:particles=50");
  scene.gravity = {0.1, -9.81, 1.0 / 3};
  scene.drag = 0.7;
  scene.particles[3].velocity = {1e-17, -1.0 / 7, 3e200};
  scene.rods[2].mass = 0.1 + 0.2;
  scene.rods[4].length = 0;  // the distance
  const Scene back = parse_scene(format_scene(scene), "f.json");
  EXPECT_EQ(back.gravity, scene.gravity);
  EXPECT_EQ(back.drag, scene.drag);
  ASSERT_EQ(back.particles.size(), scene.particles.size());
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    EXPECT_EQ(back.particles[i].position, scene.particles[i].position);
    EXPECT_EQ(back.particles[i].velocity, scene.particles[i].velocity);
    EXPECT_EQ(back.particles[i].mass, scene.particles[i].mass);
    EXPECT_EQ(back.particles[i].fixed, scene.particles[i].fixed);
  }
  ASSERT_EQ(back.rods.size(), scene.rods.size());
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    EXPECT_EQ(back.rods[i].a, scene.rods[i].a);
    EXPECT_EQ(back.rods[i].b, scene.rods[i].b);
    EXPECT_EQ(back.rods[i].length, scene.rods[i].length);
    EXPECT_EQ(back.rods[i].mass, scene.rods[i].mass);
  }
  EXPECT_EQ(format_scene(back), format_scene(scene));
}

TEST(SceneFile, UnknownKeysAreNamedWithTheirPath) {
  EXPECT_EQ(message_of(with(R"({"position": [1, 0, 0], "mass": 1, "colour": 3})")),
            "f.json: particles[1].colour is not a known key; known are position, velocity, mass, fixed");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": 1, "stiffness": 1})")),
            "f.json: rods[0].stiffness is not a known key; known are a, b, length, mass, center, inertia");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": 1})", R"(, "Gravity": [0, 0, 0])")),
            "f.json: Gravity is not a known key; known are plumb, gravity, drag, particles, rods");
}

TEST(SceneFile, MissingAndMistypedValuesAreNamedWithTheirPath) {
  EXPECT_EQ(message_of("[]"), "f.json: the scene must be an object, not an array");
  EXPECT_EQ(message_of("{}"), "f.json: plumb is missing");
  EXPECT_EQ(message_of(R"({"plumb": 2})"), "f.json: plumb is the version of the format and must be 1, not 2");
  EXPECT_EQ(message_of(R"({"plumb": 1})"), "f.json: particles is missing");
  EXPECT_EQ(message_of(R"({"plumb": 1, "particles": {}})"),
            "f.json: particles must be an array, not an object");
  EXPECT_EQ(message_of(with("7")), "f.json: particles[1] must be an object, not a number");
  EXPECT_EQ(message_of(with(R"({"mass": 1})")), "f.json: particles[1].position is missing");
  EXPECT_EQ(message_of(with(R"({"position": [1, 2]})")),
            "f.json: particles[1].position must be three numbers [x, y, z], not an array of 2");
  EXPECT_EQ(message_of(with(R"({"position": [1, "0", 2]})")),
            "f.json: particles[1].position[1] must be a number, not a string");
  EXPECT_EQ(message_of(with(R"({"position": [1, 0, 2], "fixed": 1})")),
            "f.json: particles[1].fixed must be true or false, not a number");
  EXPECT_EQ(message_of(with(R"({"position": [1, 0, 2], "mass": null})")),
            "f.json: particles[1].mass must be a number, not null");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0})")), "f.json: rods[0].b is missing");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": -1})")),
            "f.json: rods[0].b must be the number of a particle, counted from 0, not -1");
  EXPECT_EQ(message_of(with(sound, R"({"a": 0, "b": 4294967296})")),
            "f.json: rods[0].b must be the number of a particle, counted from 0, not 4294967296");
  EXPECT_EQ(
      message_of(with(sound, R"({"a": 0, "b": 1, "length": 0})")),
      "f.json: rods[0].length must be positive; leave it out for the distance between the two particles");
}

TEST(SceneFile, WhatIsNotJsonIsRefusedWithItsLine) {
  const std::string message = message_of("{\n  \"plumb\": 1,\n  oops\n}");
  EXPECT_TRUE(message.starts_with("f.json: not JSON: parse error at line 3, column ")) << message;
  EXPECT_TRUE(message_of("").starts_with("f.json: not JSON: ")) << message_of("");
  EXPECT_TRUE(
      message_of(with(sound, "", R"(, "drag": 1e999)")).starts_with("f.json: not JSON: number overflow"));
  EXPECT_EQ(message_of(R"({"plumb": 1, "plumb": 1})"),
            "f.json: the key \"plumb\" appears twice in one object");
}

TEST(SceneFile, ScenesThatCannotBeSimulatedAreRefused) {
  const std::string message = message_of(with(sound, R"({"a": 0, "b": 9})"));
  EXPECT_TRUE(message.starts_with("f.json: ")) << message;
  EXPECT_NE(message.find("rod 0"), std::string::npos) << message;
}

TEST(SceneFile, FilesAreReadAndReplacedWhole) {
  const auto folder = std::filesystem::temp_directory_path() / "plumb_scene_file_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto path = folder / "chain.json";
  const Scene scene = load_scene("chain:links=3");
  write_scene(scene, path);
  EXPECT_EQ(format_scene(load_scene(path.string())), format_scene(scene));
  {
    OutputFile unfinished(path);
    unfinished.write("half a file");
  }
  EXPECT_EQ(read_file(path), format_scene(scene));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files += entry.is_regular_file();
  EXPECT_EQ(files, 1u);
  EXPECT_THROW(OutputFile(folder / "missing" / "file"), InputError);
  EXPECT_THROW(load_scene((folder / "missing.json").string()), InputError);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace plumb::scenes
