#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plumb/vec3.hpp"

namespace plumb::tools {

/// These functions append to a glTF model. Each returns the number of what it added.
class GltfModel {
 public:
  GltfModel();

  /// Appends floats, `width` to an element (1, 3 or 4). With `bounds` it adds their least and largest values,
  /// which glTF asks for with times and corners.
  int add_floats(std::span<const float> numbers, int width, bool bounds = false);
  int add_material(const std::string& name, double red, double green, double blue);
  /// Appends a mesh of triangles with corners and normals.
  int add_mesh(const std::string& name, const std::vector<Vec3>& corners, const std::vector<Vec3>& normals,
               const std::vector<std::uint16_t>& triangles, int material);
  /// Appends a node. A `parent` of -1 puts it at the root, and a mesh of -1 gives it none.
  int add_node(const std::string& name, int mesh, int parent = -1);
  tinygltf::Node& node(int number) { return model_.nodes[static_cast<std::size_t>(number)]; }
  /// Appends a channel to the only animation: `path` of `node` takes `values` at `times`, both of which are
  /// accessors.
  void animate(int node, const char* path, int times, int values);

  std::size_t bytes() const { return model_.buffers[0].data.size(); }
  std::string to_text(bool binary) const;

 private:
  int add_view(const void* bytes, std::size_t size, int target);

  tinygltf::Model model_;
};

/// Appends meshes of size one. The cylinder has radius 1 and length 1 along y, and the ball has radius 1. The
/// cube has half size 1, and so has the square, which faces +y.
int add_cylinder(GltfModel& model, int material);
int add_ball(GltfModel& model, int material);
int add_cube(GltfModel& model, int material);
int add_square(GltfModel& model, int material);

}  // namespace plumb::tools
