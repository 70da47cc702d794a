#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::bench {

enum class Shape : std::uint8_t { chain, net, ensemble, graph };

/// Says where a scene is meant to fit. The sizes are fixed, so that runs on different machines show the same
/// scenes.
enum class Level : std::uint8_t { l1, l2, l3, dram };

std::string_view to_string(Shape);
std::string_view to_string(Level);
/// Returns "float" or "double".
std::string_view number_name(Precision);

/// Names a scene and the arithmetic it is stepped in.
struct Case {
  Shape shape = Shape::chain;
  Precision precision = Precision::single;
  Level level = Level::l2;
  std::uint32_t size = 0;  ///< links of a chain, side of a net, chains of an ensemble, particles of a graph
  bool extra = false;      ///< stands beside the grid of shapes and levels: only the layout auto is timed
};

/// Returns the size with its unit, such as "links:8191".
std::string size_name(const Case&);

/// Returns for every shape and precision one scene of about 16 kB, 512 kB, 8 MB and 200 MB. In float it adds
/// the sizes that other libraries were measured with. A chain outside the caches has 4 million links in
/// float. `full` adds 200 MB in float and 4 million links in double.
std::vector<Case> make_cases(bool full);

Scene make_scene(Shape shape, std::uint32_t size);

/// Returns the scene of a case. The last one made is kept, as large random graphs take long to make.
std::shared_ptr<const Scene> scene_of(const Case&);

}  // namespace plumb::bench
