#include "scene/bends/bends.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "scene/bends/curvature.hpp"
#include "scene/refuse.hpp"
#include "scene/tackles/tackles.hpp"

namespace plumb::detail {
namespace {

/// Finds rods by their ends.
class RodTable {
 public:
  explicit RodTable(const Scene& scene) {
    rods_.reserve(scene.rods.size());
    for (std::size_t i = 0; i < scene.rods.size(); ++i)
      rods_.emplace_back(key(scene.rods[i].a, scene.rods[i].b), i);
    std::sort(rods_.begin(), rods_.end());
  }

  std::optional<std::size_t> find(std::uint32_t a, std::uint32_t b) const {
    const auto at = std::lower_bound(rods_.begin(), rods_.end(), std::pair{key(a, b), std::size_t{0}});
    if (at == rods_.end() || at->first != key(a, b)) return std::nullopt;
    return at->second;
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    return std::uint64_t{low} << 32 | high;
  }

  std::vector<std::pair<std::uint64_t, std::size_t>> rods_;
};

std::array<std::uint32_t, 3> particles_of(const Bend& bend) {
  return {bend.a, bend.b, bend.c};
}

void validate_numbers(const Bend& bend, std::size_t i) {
  if (!(bend.stiffness >= 0 && std::isfinite(bend.stiffness)))
    refuse("bend ", i, ": stiffness must be finite and not negative, got ", bend.stiffness, " N m");
  if (!(bend.damping >= 0 && std::isfinite(bend.damping)))
    refuse("bend ", i, ": damping must be finite and not negative, got ", bend.damping, " N m s");
  if (bend.stiffness == 0 && bend.damping == 0)
    refuse("bend ", i, ": has neither stiffness nor damping, so that it holds nothing");
  if (!(bend.angle >= 0 && bend.angle < std::numbers::pi))
    refuse("bend ", i, ": angle must be at least 0 and below pi, got ", bend.angle, " rad");
}

void validate_particles(const Scene& scene, std::size_t i) {
  const Bend& bend = scene.bends[i];
  for (const std::uint32_t particle : particles_of(bend)) {
    if (particle < scene.particles.size()) continue;
    refuse("bend ", i, ": particle ", particle, " does not exist (the scene has ", scene.particles.size(),
           " particles)");
  }
  if (bend.a == bend.b || bend.b == bend.c || bend.a == bend.c)
    refuse("bend ", i, ": needs three different particles, got ", bend.a, ", ", bend.b, " and ", bend.c);
  const auto is_fixed = [&](std::uint32_t particle) { return scene.particles[particle].fixed; };
  if (is_fixed(bend.a) && is_fixed(bend.b) && is_fixed(bend.c))
    refuse("bend ", i, ": all of its particles (", bend.a, ", ", bend.b, " and ", bend.c, ") are fixed");
}

void validate_rods(const Scene& scene, const RodTable& rods, std::size_t i) {
  const Bend& bend = scene.bends[i];
  for (const auto& [from, to] : {std::pair{bend.a, bend.b}, std::pair{bend.b, bend.c}}) {
    if (rods.find(from, to)) continue;
    const Particle &first = scene.particles[from], &second = scene.particles[to];
    if (!first.fixed || !second.fixed)
      refuse("bend ", i, ": no rod joins particles ", from, " and ", to, "; only fixed particles need none");
    if (first.position == second.position)
      refuse("bend ", i, ": fixed particles ", from, " and ", to, " are at the same place");
  }
}

void refuse_duplicate_bends(const std::vector<Bend>& bends) {
  using Entry = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::size_t>;
  std::vector<Entry> sorted;
  for (std::size_t i = 0; i < bends.size(); ++i) {
    const auto [low, high] = std::minmax(bends[i].a, bends[i].c);
    sorted.emplace_back(bends[i].b, low, high, i);
  }
  std::sort(sorted.begin(), sorted.end());
  const auto particles = [](const Entry& e) {
    return std::tuple(std::get<0>(e), std::get<1>(e), std::get<2>(e));
  };
  const auto twice = std::adjacent_find(
      sorted.begin(), sorted.end(),
      [&](const Entry& first, const Entry& second) { return particles(first) == particles(second); });
  if (twice != sorted.end())
    refuse("bend ", std::get<3>(twice[1]), ": bends the same particles as bend ", std::get<3>(*twice));
}

/// Returns a movable particle of a bend.
std::uint32_t movable_of(const Scene& scene, const Bend& bend) {
  for (const std::uint32_t particle : {bend.b, bend.a})
    if (!scene.particles[particle].fixed) return particle;
  return bend.c;
}

}  // namespace

void validate_bends(const Scene& scene) {
  if (scene.bends.empty()) return;
  const RodTable rods(scene);
  for (std::size_t i = 0; i < scene.bends.size(); ++i) {
    validate_particles(scene, i);
    validate_numbers(scene.bends[i], i);
    validate_rods(scene, rods, i);
  }
  refuse_duplicate_bends(scene.bends);
}

std::vector<std::array<double, 2>> bend_lengths(const Scene& scene) {
  std::vector<std::array<double, 2>> out;
  if (scene.bends.empty()) return out;
  const RodTable rods(scene);
  const auto length = [&](std::uint32_t a, std::uint32_t b) {
    const auto rod = rods.find(a, b);
    return rod ? rod_length(scene, *rod) : norm(scene.particles[b].position - scene.particles[a].position);
  };
  out.reserve(scene.bends.size());
  for (const Bend& bend : scene.bends) out.push_back({length(bend.a, bend.b), length(bend.b, bend.c)});
  return out;
}

double bending_energy(const Scene& scene, std::span<const Vec3> positions) {
  const std::vector<std::array<double, 2>> lengths = bend_lengths(scene);
  double sum = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const Bend& bend = scene.bends[i];
    const Vec3 w = 1 / lengths[i][0] * (positions[bend.b] - positions[bend.a]) -
                   1 / lengths[i][1] * (positions[bend.c] - positions[bend.b]);
    sum += bending_energy(bend.stiffness, curvature_of_angle(bend.angle), dot(w, w));
  }
  return sum;
}

layouts::Islands find_bent_islands(const Scene& scene, const layouts::Graph& graph) {
  if (scene.bends.empty() && scene.tackles.empty()) return layouts::find_islands(graph);
  std::vector<layouts::Edge> edges(graph.edges.begin(), graph.edges.end());
  const auto rods = static_cast<std::uint32_t>(edges.size());
  for (const Bend& bend : scene.bends) {
    const std::uint32_t hub = movable_of(scene, bend);
    for (const std::uint32_t particle : particles_of(bend))
      if (particle != hub) edges.push_back({hub, particle});
  }
  join_tackles(scene, edges);
  layouts::Islands islands = layouts::find_islands({graph.vertices, edges, graph.movable});
  // Only rods stay. An island's edges ascend, so that its own come first.
  std::vector<std::uint32_t> begin{0}, list;
  for (std::uint32_t i = 0; i < islands.count(); ++i) {
    for (const std::uint32_t edge : islands.edges(i))
      if (edge < rods) list.push_back(edge);
    begin.push_back(static_cast<std::uint32_t>(list.size()));
  }
  islands.edge_begin = std::move(begin);
  islands.edge_list = std::move(list);
  return islands;
}

std::vector<std::vector<std::uint32_t>> by_island(const Scene& scene, const layouts::Islands& islands,
                                                  std::span<const std::uint32_t> movable) {
  if (movable.empty()) return {};
  std::vector<std::uint32_t> island_of(scene.particles.size(), 0);
  for (std::uint32_t i = 0; i < islands.count(); ++i)
    for (const std::uint32_t particle : islands.vertices(i))
      if (!scene.particles[particle].fixed) island_of[particle] = i;
  std::vector<std::vector<std::uint32_t>> out(islands.count());
  for (std::uint32_t i = 0; i < movable.size(); ++i) out[island_of[movable[i]]].push_back(i);
  return out;
}

std::vector<std::vector<std::uint32_t>> bends_by_island(const Scene& scene, const layouts::Islands& islands) {
  std::vector<std::uint32_t> movable;
  for (const Bend& bend : scene.bends) movable.push_back(movable_of(scene, bend));
  return by_island(scene, islands, movable);
}

}  // namespace plumb::detail
