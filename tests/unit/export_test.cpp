#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

#include "export/base64.hpp"
#include "export/gltf.hpp"
#include "export/vtk.hpp"
#include "plumb/error.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
namespace {

Point particle(std::uint32_t number) {
  return {.particles = {number, 0, 0, 0}, .weights = {1, 0, 0, 0}};
}

Frame frame_of(const Scene& scene, double t) {
  Frame frame{.t = t, .positions = {}, .velocities = {}};
  for (const Particle& p : scene.particles) {
    frame.positions.push_back(p.position);
    frame.velocities.push_back(p.velocity);
  }
  return frame;
}

/// A capsule, a rod, a ball, a loose particle, ground.
Scene mixed() {
  Scene scene;
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{0, 1, 0}, Vec3{2, 1, 0}, Vec3{5, 5, 5}, Vec3{6, 6, 6}})
    scene.particles.push_back({.position = at, .mass = 1});
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  scene.capsules = {{.a = particle(1), .b = particle(0), .radius = 0.25},
                    {.a = particle(3), .b = particle(3), .radius = 0.5}};
  scene.planes.push_back({.normal = {1, 0, 0}, .offset = -3});
  return scene;
}

tinygltf::Model read_gltf(const std::string& text, bool binary) {
  tinygltf::TinyGLTF reader;
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(text.size());
  const bool read =
      binary ? reader.LoadBinaryFromMemory(&model, &error, &warning,
                                           reinterpret_cast<const unsigned char*>(text.data()), size)
             : reader.LoadASCIIFromString(&model, &error, &warning, text.data(), size, "");
  EXPECT_TRUE(read) << error;
  EXPECT_EQ(error, "");
  EXPECT_EQ(warning, "");
  return model;
}

std::vector<double> floats_of(const tinygltf::Model& model, int accessor_number) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(accessor_number));
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  const std::size_t width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(accessor.type));
  std::vector<float> floats(accessor.count * width);
  std::memcpy(floats.data(), model.buffers.at(0).data.data() + view.byteOffset, view.byteLength);
  return {floats.begin(), floats.end()};
}

int node_named(const tinygltf::Model& model, const std::string& name) {
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (model.nodes[i].name == name) return static_cast<int>(i);
  ADD_FAILURE() << "no node " << name;
  return 0;
}

/// What moves `node`; empty if nothing does.
std::vector<double> channel_of(const tinygltf::Model& model, const std::string& node,
                               const std::string& path) {
  const int number = node_named(model, node);
  for (const tinygltf::AnimationChannel& channel : model.animations.at(0).channels)
    if (channel.target_node == number && channel.target_path == path)
      return floats_of(model,
                       model.animations[0].samplers.at(static_cast<std::size_t>(channel.sampler)).output);
  return {};
}

/// Where +y goes under a rotation x, y, z, w.
Vec3 turned_up(const double* q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  return {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
}

TEST(Base64, PadsAsItsStandardSays) {
  const auto encode = [](std::string_view text) {
    return encode_base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode("\xff\xfe\xfd"), "//79");
}

TEST(Limbs, AreCapsulesThenOtherRodsThenLooseParticles) {
  const std::vector<scenes::Limb> limbs = scenes::list_limbs(mixed());
  ASSERT_EQ(limbs.size(), 4u);
  EXPECT_EQ(limbs[0].rod, 0u);
  EXPECT_EQ(limbs[0].radius, 0.25);
  EXPECT_EQ(limbs[1].particle, 3u);
  EXPECT_TRUE(limbs[1].is_ball());
  EXPECT_EQ(limbs[2].rod, 1u);
  EXPECT_EQ(limbs[3].particle, 4u);
  EXPECT_EQ(limbs[3].radius, 0);
}

TEST(Limbs, PlacesAreWeightedMeans) {
  const std::vector<Vec3> positions = {{1, 0, 0}, {3, 0, 0}, {0, 4, 0}};
  const Point beyond{.particles = {0, 1, 2, 0}, .weights = {-0.5, 1, 0.5, 0}};
  EXPECT_EQ(scenes::place_of(beyond, positions), (Vec3{2.5, 2, 0}));
}

TEST(Gltf, NodesFollowTheirRods) {
  const Scene scene = mixed();
  Frame moved = frame_of(scene, 0.5);
  moved.positions = {{0, 0, 1}, {0, 0, 3}, {-1, 0, 3}, {5, 4, 5}, {7, 7, 7}};
  GltfAnimation animation(scene);
  animation.add(frame_of(scene, 0));
  animation.add(moved);
  for (const bool binary : {true, false}) {
    const tinygltf::Model model = read_gltf(animation.to_text(binary), binary);
    ASSERT_EQ(model.animations.size(), 1u);
    EXPECT_EQ(floats_of(model, model.animations[0].samplers[0].input), (std::vector<double>{0, 0.5}));
    // The capsule runs from particle 1 to particle 0, the rod from 1 to 2.
    const std::vector<double> middle = channel_of(model, "limb 0", "translation");
    EXPECT_EQ(middle, (std::vector<double>{0, 0.5, 0, 0, 0, 2}));
    const std::vector<double> turn = channel_of(model, "limb 0", "rotation");
    ASSERT_EQ(turn.size(), 8u);
    EXPECT_LT(norm(turned_up(&turn[0]) - Vec3{0, -1, 0}), 1e-6);  // float
    EXPECT_LT(norm(turned_up(&turn[4]) - Vec3{0, 0, -1}), 1e-6);
    EXPECT_TRUE(channel_of(model, "limb 0", "scale").empty());
    const std::vector<double> rod_turn = channel_of(model, "rod 1", "rotation");
    EXPECT_LT(norm(turned_up(&rod_turn[0]) - Vec3{1, 0, 0}), 1e-6);
    EXPECT_LT(norm(turned_up(&rod_turn[4]) - Vec3{-1, 0, 0}), 1e-6);
    const std::vector<double> scale = channel_of(model, "rod 1", "scale");
    EXPECT_EQ(scale.at(1), 2);
    EXPECT_EQ(scale.at(4), 1);  // it is shorter by then
    EXPECT_EQ(channel_of(model, "ball 1", "translation"), (std::vector<double>{5, 5, 5, 5, 4, 5}));
    EXPECT_EQ(channel_of(model, "particle 4", "translation"), (std::vector<double>{6, 6, 6, 7, 7, 7}));
    const tinygltf::Node& plane = model.nodes[static_cast<std::size_t>(node_named(model, "plane"))];
    EXPECT_EQ(plane.translation, (std::vector<double>{-3, 0, 0}));
    EXPECT_LT(norm(turned_up(plane.rotation.data()) - Vec3{1, 0, 0}), 1e-12);
  }
}

TEST(Gltf, RotationsGoOnFromOneAnother) {
  // Once around in small steps: neighbouring quaternions are near each other, never the same turn with the
  // opposite sign.
  Scene scene = scenes::make_chain(1, 1.0, 1.0);
  GltfAnimation animation(scene);
  constexpr int steps = 40;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 2 * 3.141592653589793 * i / steps;
    scene.particles[1].position = {std::cos(angle), std::sin(angle), 0};
    animation.add(frame_of(scene, i));
  }
  const tinygltf::Model model = read_gltf(animation.to_text(true), true);
  const std::vector<double> turn = channel_of(model, "rod 0", "rotation");
  for (std::size_t i = 4; i < turn.size(); i += 4) {
    double product = 0;
    for (std::size_t k = 0; k < 4; ++k) product += turn[i + k] * turn[i + k - 4];
    EXPECT_GT(product, std::cos(3.2 / steps)) << i / 4;  // half the angle of a step, and a little
  }
}

TEST(Gltf, MeshesFaceOutwards) {
  const Scene scene = mixed();
  GltfAnimation animation(scene);
  animation.add(frame_of(scene, 0));
  const tinygltf::Model model = read_gltf(animation.to_text(true), true);
  ASSERT_EQ(model.meshes.size(), 4u);
  for (const tinygltf::Mesh& mesh : model.meshes) {
    const tinygltf::Primitive& primitive = mesh.primitives.at(0);
    const std::vector<double> corners = floats_of(model, primitive.attributes.at("POSITION"));
    const std::vector<double> normals = floats_of(model, primitive.attributes.at("NORMAL"));
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(primitive.indices));
    std::vector<std::uint16_t> indices(accessor.count);
    std::memcpy(indices.data(),
                model.buffers[0].data.data() +
                    model.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteOffset,
                accessor.count * sizeof indices[0]);
    const auto vector = [](const std::vector<double>& from, std::size_t i) {
      return Vec3{from.at(3 * i), from.at(3 * i + 1), from.at(3 * i + 2)};
    };
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      const Vec3 a = vector(corners, indices[i]), b = vector(corners, indices[i + 1]),
                 c = vector(corners, indices[i + 2]);
      const Vec3 facing = cross(b - a, c - a);
      if (norm(facing) < 1e-6) continue;  // at a ball's poles
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_GT(dot(facing, vector(normals, indices[i + k])), 0) << mesh.name << " " << i / 3;
    }
  }
}

TEST(Gltf, RefusesAnAnimationWithoutFrames) {
  const Scene scene = scenes::make_chain(2);
  EXPECT_THROW(GltfAnimation(scene).to_text(true), InputError);
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
