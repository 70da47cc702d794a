#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plumb/vec3.hpp"

namespace plumb::tools {

/// Appends to a glTF model; each returns the number of what it added.
class GltfModel {
 public:
  GltfModel();

  /// Floats, `width` to an element (1, 3 or 4). `bounds`: with their least and largest, which glTF asks of
  /// times and corners.
  int add_floats(std::span<const float> numbers, int width, bool bounds = false);
  int add_material(const std::string& name, double red, double green, double blue);
  /// Triangles of corners and normals.
  int add_mesh(const std::string& name, const std::vector<Vec3>& corners, const std::vector<Vec3>& normals,
               const std::vector<std::uint16_t>& triangles, int material);
  /// `parent` -1: at the root. A mesh of -1 is none.
  int add_node(const std::string& name, int mesh, int parent = -1);
  tinygltf::Node& node(int number) { return model_.nodes[static_cast<std::size_t>(number)]; }
  /// A channel of the one animation there is: `path` of `node` takes `values` at `times` (both accessors).
  void animate(int node, const char* path, int times, int values);

  std::size_t bytes() const { return model_.buffers[0].data.size(); }
  std::string to_text(bool binary) const;

 private:
  int add_view(const void* bytes, std::size_t size, int target);

  tinygltf::Model model_;
};

/// Meshes of size one: a cylinder and a ball of radius 1 (the cylinder of length 1 along y), a cube of half
/// size 1, a square of half size 1 that faces +y.
int add_cylinder(GltfModel& model, int material);
int add_ball(GltfModel& model, int material);
int add_cube(GltfModel& model, int material);
int add_square(GltfModel& model, int material);

}  // namespace plumb::tools
