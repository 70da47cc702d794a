// A path of four vertices is a chain, and two colours are enough for it.
#include <plumb/layouts/coloring.hpp>
#include <plumb/layouts/shapes.hpp>

int main() {
  using namespace plumb::layouts;
  const Edge edges[] = {{0, 1}, {1, 2}, {2, 3}};
  const std::uint8_t movable[] = {0, 1, 1, 1};
  const Graph graph{4, edges, movable};
  const Coloring coloring = color_edges(graph);
  const bool right =
      detect_shape(graph).shape == Shape::chain && coloring.colors == 2 && is_valid(graph, coloring);
  return right ? 0 : 1;
}
