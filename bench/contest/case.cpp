#include "contest/case.hpp"

#include <array>

#include "scenes/generators/generators.hpp"

namespace plumb::bench {
namespace {

constexpr std::array shapes{Shape::chain, Shape::net, Shape::ensemble, Shape::graph};
constexpr std::array levels{Level::l1, Level::l2, Level::l3, Level::dram};

// These sizes fill the levels. A world holds about 80 bytes per rod of a chain in float, 56 of a net, 70 of a
// graph, and twice that in double. A sweep touches a third of them.
constexpr std::uint32_t float_sizes[4][4] = {
    {255, 8191, 131071, 4000000}, {16, 64, 256, 1400}, {16, 256, 4096, 81920}, {128, 4096, 65536, 1200000}};
constexpr std::uint32_t double_sizes[4][4] = {
    {127, 4095, 65535, 2000000}, {12, 48, 180, 1000}, {8, 128, 2048, 40960}, {64, 2048, 32768, 600000}};

}  // namespace

std::string_view to_string(Shape shape) {
  constexpr std::string_view names[] = {"chain", "net", "ensemble", "graph"};
  return names[static_cast<int>(shape)];
}

std::string_view to_string(Level level) {
  constexpr std::string_view names[] = {"L1", "L2", "L3", "DRAM"};
  return names[static_cast<int>(level)];
}

std::string_view number_name(Precision precision) {
  return precision == Precision::single ? "float" : "double";
}

std::string size_name(const Case& c) {
  constexpr const char* units[] = {"links:", "side:", "chains:", "particles:"};
  return units[static_cast<int>(c.shape)] + std::to_string(c.size);
}

std::vector<Case> make_cases(bool full) {
  std::vector<Case> cases;
  for (const Level level : levels) {
    for (const Shape shape : shapes) {
      const auto row = static_cast<int>(shape), column = static_cast<int>(level);
      cases.push_back({shape, Precision::single, level, float_sizes[row][column]});
      cases.push_back({shape, Precision::double_, level, double_sizes[row][column]});
    }
  }
  cases.push_back({Shape::chain, Precision::single, Level::l1, 64, true});
  cases.push_back({Shape::chain, Precision::single, Level::l2, 1024, true});
  cases.push_back({Shape::net, Precision::single, Level::l2, 32, true});
  cases.push_back({Shape::net, Precision::single, Level::l3, 128, true});
  cases.push_back({Shape::ensemble, Precision::single, Level::l3, 1000, true});
  if (full) {
    cases.push_back({Shape::chain, Precision::single, Level::dram, 2500000, true});
    cases.push_back({Shape::chain, Precision::double_, Level::dram, 4000000, true});
  }
  return cases;
}

Scene make_scene(Shape shape, std::uint32_t size) {
  switch (shape) {
    case Shape::chain:
      return scenes::make_chain(size);
    case Shape::net:
      return scenes::make_net(size, size);
    case Shape::ensemble:
      return scenes::make_ensemble({.chains = size, .links = 32, .end_mass = 10});
    case Shape::graph:
      break;
  }
  return scenes::make_graph({.particles = size});
}

std::shared_ptr<const Scene> scene_of(const Case& c) {
  static std::shared_ptr<const Scene> last;
  static Shape shape;
  static std::uint32_t size;
  if (!last || shape != c.shape || size != c.size) {
    last.reset();  // two of the largest need not fit at once
    last = std::make_shared<const Scene>(make_scene(c.shape, c.size));
    shape = c.shape;
    size = c.size;
  }
  return last;
}

}  // namespace plumb::bench
