#include "export/gltf_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

namespace plumb::tools {
namespace {

std::vector<float> flatten(const std::vector<Vec3>& vectors) {
  std::vector<float> out;
  for (const Vec3& v : vectors)
    out.insert(out.end(), {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
  return out;
}

int last_of(const auto& list) {
  return static_cast<int>(list.size()) - 1;
}

/// Corners, normals and triangles that grow together.
struct Surface {
  std::vector<Vec3> corners, normals;
  std::vector<std::uint16_t> triangles;

  void add_corner(Vec3 corner, Vec3 normal) {
    corners.push_back(corner);
    normals.push_back(normal);
  }
  /// Adds two triangles. They face the side from which a, b, c, d go round anticlockwise.
  void add_quad(std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    for (const std::size_t corner : {a, b, c, a, c, d})
      triangles.push_back(static_cast<std::uint16_t>(corner));
  }
};

/// Adds a square with `normal`, whose sides have half size 1 and whose middle is at `center`.
void add_face(Surface& surface, Vec3 center, Vec3 normal, Vec3 side) {
  const Vec3 other = cross(normal, side);
  const std::size_t first = surface.corners.size();
  for (const auto& [s, o] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    surface.add_corner(center + static_cast<double>(s) * side + static_cast<double>(o) * other, normal);
  surface.add_quad(first, first + 1, first + 2, first + 3);
}

int add_surface(GltfModel& model, const std::string& name, const Surface& surface, int material) {
  return model.add_mesh(name, surface.corners, surface.normals, surface.triangles, material);
}

}  // namespace

GltfModel::GltfModel() {
  model_.asset.version = "2.0";
  model_.asset.generator = "plumb";
  model_.buffers.emplace_back();
  model_.scenes.emplace_back();
  model_.defaultScene = 0;
}

int GltfModel::add_view(const void* bytes, std::size_t size, int target) {
  std::vector<unsigned char>& data = model_.buffers[0].data;
  data.resize((data.size() + 3) / 4 * 4);  // Numbers must begin at multiples of their size.
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = data.size();
  view.byteLength = size;
  view.target = target;
  data.resize(data.size() + size);
  if (size > 0) std::memcpy(data.data() + view.byteOffset, bytes, size);
  model_.bufferViews.push_back(view);
  return last_of(model_.bufferViews);
}

int GltfModel::add_floats(std::span<const float> numbers, int width, bool bounds) {
  tinygltf::Accessor accessor;
  // glTF asks for bounds of the corners of meshes and of times. Of these, corners alone have three
  // components.
  accessor.bufferView = add_view(numbers.data(), numbers.size_bytes(), 0);
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.count = numbers.size() / static_cast<std::size_t>(width);
  accessor.type = width == 1 ? TINYGLTF_TYPE_SCALAR : width == 3 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4;
  for (int c = 0; bounds && c < width; ++c) {
    float least = numbers[static_cast<std::size_t>(c)], most = least;
    for (std::size_t i = static_cast<std::size_t>(c); i < numbers.size();
         i += static_cast<std::size_t>(width)) {
      least = std::min(least, numbers[i]);
      most = std::max(most, numbers[i]);
    }
    accessor.minValues.push_back(least);
    accessor.maxValues.push_back(most);
  }
  model_.accessors.push_back(accessor);
  return last_of(model_.accessors);
}

int GltfModel::add_material(const std::string& name, double red, double green, double blue) {
  tinygltf::Material material;
  material.name = name;
  material.pbrMetallicRoughness.baseColorFactor = {red, green, blue, 1};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.8;
  material.doubleSided = true;
  model_.materials.push_back(material);
  return last_of(model_.materials);
}

int GltfModel::add_mesh(const std::string& name, const std::vector<Vec3>& corners,
                        const std::vector<Vec3>& normals, const std::vector<std::uint16_t>& triangles,
                        int material) {
  tinygltf::Primitive primitive;
  primitive.attributes["POSITION"] = add_floats(flatten(corners), 3, true);
  primitive.attributes["NORMAL"] = add_floats(flatten(normals), 3);
  tinygltf::Accessor indices;
  indices.bufferView = add_view(triangles.data(), triangles.size() * sizeof triangles[0],
                                TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  indices.count = triangles.size();
  indices.type = TINYGLTF_TYPE_SCALAR;
  model_.accessors.push_back(indices);
  primitive.indices = last_of(model_.accessors);
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = material;
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(primitive);
  model_.meshes.push_back(mesh);
  return last_of(model_.meshes);
}

int GltfModel::add_node(const std::string& name, int mesh, int parent) {
  tinygltf::Node added;
  added.name = name;
  added.mesh = mesh;
  model_.nodes.push_back(added);
  const int number = last_of(model_.nodes);
  (parent < 0 ? model_.scenes[0].nodes : node(parent).children).push_back(number);
  return number;
}

void GltfModel::animate(int node, const char* path, int times, int values) {
  if (model_.animations.empty()) {
    model_.animations.emplace_back();
    model_.animations[0].name = "run";
  }
  tinygltf::Animation& animation = model_.animations[0];
  tinygltf::AnimationSampler sampler;
  sampler.input = times;
  sampler.output = values;
  sampler.interpolation = "LINEAR";
  animation.samplers.push_back(sampler);
  tinygltf::AnimationChannel channel;
  channel.sampler = last_of(animation.samplers);
  channel.target_node = node;
  channel.target_path = path;
  animation.channels.push_back(channel);
}

std::string GltfModel::to_text(bool binary) const {
  std::ostringstream out;
  tinygltf::TinyGLTF writer;
  writer.WriteGltfSceneToStream(&model_, out, !binary, binary);
  return out.str();
}

int add_cylinder(GltfModel& model, int material) {
  constexpr std::size_t sides = 16;
  Surface surface;
  for (std::size_t i = 0; i <= sides; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / sides;
    const Vec3 out{std::sin(angle), 0, std::cos(angle)};
    surface.add_corner(out + Vec3{0, -0.5, 0}, out);
    surface.add_corner(out + Vec3{0, 0.5, 0}, out);
    if (i > 0) surface.add_quad(2 * i - 2, 2 * i, 2 * i + 1, 2 * i - 1);
  }
  for (const double end : {-0.5, 0.5}) {
    const Vec3 normal{0, 2 * end, 0};
    const std::size_t first = surface.corners.size();
    for (std::size_t i = 0; i < sides; ++i) {
      const double angle = 4 * end * std::numbers::pi * static_cast<double>(i) / sides;
      surface.add_corner({std::sin(angle), end, std::cos(angle)}, normal);
      if (i >= 2)
        for (const std::size_t corner : {first, first + i - 1, first + i})
          surface.triangles.push_back(static_cast<std::uint16_t>(corner));
    }
  }
  return add_surface(model, "cylinder", surface, material);
}

int add_ball(GltfModel& model, int material) {
  constexpr std::size_t rings = 8, sides = 16;
  Surface surface;
  for (std::size_t ring = 0; ring <= rings; ++ring) {
    const double up = std::numbers::pi * static_cast<double>(ring) / rings;
    for (std::size_t i = 0; i <= sides; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / sides;
      const Vec3 out{std::sin(up) * std::sin(angle), std::cos(up), std::sin(up) * std::cos(angle)};
      surface.add_corner(out, out);
      const std::size_t here = surface.corners.size() - 1, above = here - sides - 1;
      if (ring > 0 && i > 0) surface.add_quad(here - 1, here, above, above - 1);
    }
  }
  return add_surface(model, "ball", surface, material);
}

int add_cube(GltfModel& model, int material) {
  Surface surface;
  for (const double sign : {-1.0, 1.0}) {
    add_face(surface, {sign, 0, 0}, {sign, 0, 0}, {0, 1, 0});
    add_face(surface, {0, sign, 0}, {0, sign, 0}, {0, 0, 1});
    add_face(surface, {0, 0, sign}, {0, 0, sign}, {1, 0, 0});
  }
  return add_surface(model, "box", surface, material);
}

int add_square(GltfModel& model, int material) {
  Surface surface;
  add_face(surface, {}, {0, 1, 0}, {0, 0, 1});
  return add_surface(model, "plane", surface, material);
}

}  // namespace plumb::tools
