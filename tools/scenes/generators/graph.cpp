// make_graph strews particles over a cube. It joins them by the shortest links that connect them, then by the
// next shortest until the mean degree is reached.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <tuple>
#include <vector>

#include "plumb/error.hpp"
#include "scenes/basics/require.hpp"
#include "scenes/basics/seeded.hpp"
#include "scenes/generators/generators.hpp"

namespace plumb::scenes {
namespace {

struct Pair {
  double squared;  ///< Distance squared, in m².
  std::uint32_t a;
  std::uint32_t b;
  friend bool operator<(const Pair& l, const Pair& r) {
    return std::tie(l.squared, l.a, l.b) < std::tie(r.squared, r.a, r.b);
  }
};

/// Particles are sorted into cubic cells of side `reach`, so that all within reach lie in the 27 cells
/// around.
class Cells {
 public:
  Cells(double side, double reach)
      : reach_(reach),
        n_(std::max<std::uint32_t>(1, static_cast<std::uint32_t>(side / reach))),
        members_(std::size_t{n_} * n_ * n_) {}

  void insert(std::uint32_t id, Vec3 p) { members_[cell(index(p.x), index(p.y), index(p.z))].push_back(id); }

  template <class Visit>
  void visit_near(Vec3 p, Visit visit) const {
    const std::uint32_t cx = index(p.x), cy = index(p.y), cz = index(p.z);
    for (std::uint32_t x = cx - (cx > 0); x <= std::min(cx + 1, n_ - 1); ++x) {
      for (std::uint32_t y = cy - (cy > 0); y <= std::min(cy + 1, n_ - 1); ++y) {
        for (std::uint32_t z = cz - (cz > 0); z <= std::min(cz + 1, n_ - 1); ++z) {
          for (const std::uint32_t id : members_[cell(x, y, z)]) visit(id);
        }
      }
    }
  }

 private:
  std::uint32_t index(double v) const { return std::min(static_cast<std::uint32_t>(v / reach_), n_ - 1); }
  std::size_t cell(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{x} * n_ + y) * n_ + z;
  }

  double reach_;
  std::uint32_t n_;
  std::vector<std::vector<std::uint32_t>> members_;
};

/// Returns random places, none closer to another than a fifth of the spacing. A rod of nearly no length would
/// say more about rounding than about the method.
std::vector<Vec3> strew(const GraphShape& shape, double side, std::mt19937_64& random) {
  const double least = 0.2 * shape.spacing;
  Cells cells(side, shape.spacing);
  std::vector<Vec3> places;
  places.reserve(shape.particles);
  while (places.size() < shape.particles) {
    const double x = side * unit_double(random);
    const double y = side * unit_double(random);
    const double z = side * unit_double(random);
    const Vec3 p{x, y, z};
    bool free = true;
    cells.visit_near(p, [&](std::uint32_t id) {
      const Vec3 d = places[id] - p;
      free = free && dot(d, d) >= least * least;
    });
    if (!free) continue;
    cells.insert(static_cast<std::uint32_t>(places.size()), p);
    places.push_back(p);
  }
  return places;
}

std::vector<Pair> pairs_within(const std::vector<Vec3>& places, double side, double reach) {
  Cells cells(side, reach);
  std::vector<Pair> pairs;
  for (std::uint32_t b = 0; b < places.size(); ++b) {
    cells.visit_near(places[b], [&](std::uint32_t a) {
      const Vec3 d = places[b] - places[a];
      if (dot(d, d) <= reach * reach) pairs.push_back({dot(d, d), a, b});
    });
    cells.insert(b, places[b]);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Returns the spanning forest of shortest pairs (Kruskal), then the shortest of the rest until there are
/// `count`.
std::vector<Pair> choose(const std::vector<Pair>& pairs, std::uint32_t particles, std::size_t count) {
  std::vector<std::uint32_t> parent(particles);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::vector<Pair> chosen;
  std::vector<Pair> rest;
  for (const Pair& pair : pairs) {
    const std::uint32_t a = root(pair.a), b = root(pair.b);
    (a == b ? rest : chosen).push_back(pair);
    parent[a] = b;
  }
  for (std::size_t i = 0; i < rest.size() && chosen.size() < count; ++i) chosen.push_back(rest[i]);
  std::sort(chosen.begin(), chosen.end(),
            [](const Pair& l, const Pair& r) { return std::tie(l.a, l.b) < std::tie(r.a, r.b); });
  return chosen;
}

/// Fixes the uppermost particles. It passes over those tied to a fixed one, since no rod may have both ends
/// fixed.
void fix_some(Scene& scene) {
  std::vector<std::vector<std::uint32_t>> tied(scene.particles.size());
  for (const Rod& rod : scene.rods) {
    tied[rod.a].push_back(rod.b);
    tied[rod.b].push_back(rod.a);
  }
  std::vector<std::uint32_t> from_top(scene.particles.size());
  std::iota(from_top.begin(), from_top.end(), 0u);
  std::stable_sort(from_top.begin(), from_top.end(), [&](std::uint32_t l, std::uint32_t r) {
    return scene.particles[l].position.y > scene.particles[r].position.y;
  });
  std::size_t left = 1 + scene.particles.size() / 50;
  for (const std::uint32_t id : from_top) {
    if (left == 0) break;
    if (std::any_of(tied[id].begin(), tied[id].end(),
                    [&](auto other) { return scene.particles[other].fixed; })) {
      continue;
    }
    scene.particles[id].fixed = true;
    scene.particles[id].mass = 0;
    --left;
  }
}

}  // namespace

Scene make_graph(const GraphShape& shape) {
  require_at_least(shape.particles, 2, "particles");
  require_countable(shape.particles);
  require_positive(shape.spacing, "spacing");
  // Within two spacings a particle has about 33 neighbours, half of them lost at the cube's faces.
  if (!(shape.degree >= 0 && shape.degree <= 16)) throw InputError("degree must be from 0 to 16");

  std::mt19937_64 random(shape.seed);
  // Spacings are whole numbers, since std::cbrt and std::pow may differ in the last bit between C libraries.
  double side = 1;
  while (side * side * side < shape.particles) ++side;
  side *= shape.spacing;
  const std::vector<Vec3> places = strew(shape, side, random);
  const auto count = static_cast<std::size_t>(0.5 * shape.degree * shape.particles);

  Scene scene;
  scene.particles.reserve(places.size());
  for (const Vec3& p : places) {
    scene.particles.push_back({.position = p, .velocity = {}, .mass = 0.5 + 1.5 * unit_double(random)});
  }
  for (const Pair& pair : choose(pairs_within(places, side, 2 * shape.spacing), shape.particles, count)) {
    scene.rods.push_back({.a = pair.a, .b = pair.b, .length = norm(places[pair.b] - places[pair.a])});
  }
  fix_some(scene);
  return scene;
}

}  // namespace plumb::scenes
