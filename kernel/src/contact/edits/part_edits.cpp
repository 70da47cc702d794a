#include "contact/edits/part_edits.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "contact/linkage/scene_parts.hpp"
#include "contact/platforms/anchored.hpp"
#include "plumb/joints.hpp"

namespace plumb::detail {
namespace {

/// Returns the particles that places have a share of, ascending.
Array<std::uint32_t> particles_of(const Capsule& capsule) {
  Array<std::uint32_t> out;
  for (const Point* const point : {&capsule.a, &capsule.b})
    for (std::size_t k = 0; k < point->particles.size(); ++k)
      if (point->weights[k] != 0) out.push_back(point->particles[k]);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

bool has_share(const Capsule& capsule, std::uint32_t particle) {
  const auto is_of = [&](const Point& point) {
    for (std::size_t k = 0; k < point.particles.size(); ++k)
      if (point.weights[k] != 0 && point.particles[k] == particle) return true;
    return false;
  };
  return is_of(capsule.a) || is_of(capsule.b);
}

/// Returns by particle the island that all but shapes hold together, and one that none has for fixed ones.
Array<std::uint32_t> bare_islands(Scene scene) {
  scene.capsules.clear();
  scene.hulls.clear();
  const SceneParts parts(scene);
  Array<std::uint32_t> out(scene.particles.size(), parts.count());
  for (std::uint32_t p = 0; p < parts.count(); ++p)
    for (const std::uint32_t particle : parts.particles(p))
      if (!scene.particles[particle].fixed) out[particle] = p;
  return out;
}

/// Returns whether a capsule has movable particles of several islands.
bool joins_islands(const Scene& scene, const Array<std::uint32_t>& islands, const Capsule& capsule) {
  Array<std::uint32_t> of;
  for (const std::uint32_t particle : particles_of(capsule))
    if (!scene.particles[particle].fixed) of.push_back(islands[particle]);
  return std::any_of(of.begin(), of.end(), [&](std::uint32_t island) { return island != of.front(); });
}

}  // namespace

NamedPart NamedPart::with_particles(const std::vector<Particle>& of_whole) const {
  NamedPart out = *this;
  Array<std::uint32_t>& named = out.names.particles;
  const auto for_all = [&](auto&& f) {
    for_lists(
        [&](std::size_t, auto& list) {
          for (auto& item : list) for_particles(item, f);
        },
        out.scene);
  };
  for_all([&](std::uint32_t particle) { named.push_back(particle); });
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  for_all([&](std::uint32_t& particle) {
    particle =
        static_cast<std::uint32_t>(std::lower_bound(named.begin(), named.end(), particle) - named.begin());
  });
  for (const std::uint32_t particle : named) out.scene.particles.push_back(of_whole[particle]);
  return out;
}

void NamedPart::cut(std::uint32_t number, const PartEdits& edits) {
  const auto at = std::find(names.rods.begin(), names.rods.end(), number);
  if (at == names.rods.end()) return;
  const auto index = static_cast<std::size_t>(at - names.rods.begin());
  Rod& rod = scene.rods[index];
  const RodMass mass = rod_mass(scene, index, MassModel::consistent);
  const auto [a, b] = std::minmax(rod.a, rod.b);
  const Array<std::uint32_t> ends{a, b};
  const auto is_along = [&](std::uint32_t one, std::uint32_t two) {
    return std::min(one, two) == ends[0] && std::max(one, two) == ends[1];
  };
  erase_numbered(scene.bends, names.bends,
                 [&](const Bend& bend) { return is_along(bend.a, bend.b) || is_along(bend.b, bend.c); });
  end_capsules_along(ends, edits);
  if (mass.ab != 0) {
    rod.law = {.stiffness = 0};
    return;
  }
  scene.particles[rod.a].mass += mass.aa;
  scene.particles[rod.b].mass += mass.bb;
  const auto offset = static_cast<std::ptrdiff_t>(index);
  scene.rods.erase(scene.rods.begin() + offset);
  names.rods.erase(names.rods.begin() + offset);
}

void NamedPart::sever(const Names& joints) {
  for_lists(
      [&](std::size_t kind, auto& list) {
        const Array<std::uint32_t>& ended = *joints.all()[kind];
        Array<std::uint32_t>& numbers = *names.all()[kind];
        if (ended.empty()) return;
        std::size_t next = 0;
        erase_numbered(list, numbers, [&](const auto&) {
          return std::binary_search(ended.begin(), ended.end(), numbers[next++]);
        });
      },
      scene);
}

bool NamedPart::is_bare_without(const Array<std::uint32_t>& ends, std::uint32_t particle) const {
  const auto is_at = [&](const Capsule& capsule) {
    return has_share(capsule, particle) && particles_of(capsule) != ends;
  };
  const auto is_of = [&](const Hull& hull) {
    const auto& of = scene.bodies[hull.body].particles;
    return std::count(of.begin(), of.end(), particle) > 0;
  };
  return !scene.particles[particle].fixed &&
         std::none_of(scene.capsules.begin(), scene.capsules.end(), is_at) &&
         std::none_of(scene.hulls.begin(), scene.hulls.end(), is_of);
}

void NamedPart::end_capsules_along(const Array<std::uint32_t>& ends, const PartEdits& edits) {
  Array<std::uint32_t> bare;
  for (const std::uint32_t end : ends)
    if (is_bare_without(ends, end)) bare.push_back(end);
  std::optional<Capsule> last;
  auto next = bare.begin();
  erase_numbered(scene.capsules, names.capsules, [&](Capsule& capsule) {
    if (particles_of(capsule) != ends) return false;
    if (next == bare.end()) return true;
    capsule.a = capsule.b = point_at(*next++);
    last = capsule;
    return false;
  });
  if (!last || next == bare.end()) return;
  last->a = last->b = point_at(*next);
  scene.capsules.push_back(*last);
  names.capsules.push_back(edits.number_of_sphere());
}

Particle* NamedPart::find(std::uint32_t particle) {
  const auto at = std::find(names.particles.begin(), names.particles.end(), particle);
  return at == names.particles.end()
             ? nullptr
             : &scene.particles[static_cast<std::size_t>(at - names.particles.begin())];
}

void NamedPart::refix(const PartEdits& edits) {
  for (const std::uint32_t particle : edits.freed)  // first: it may hold what another one held that is fixed
    if (Particle* const own = find(particle)) own->fixed = false;
  for (const std::uint32_t particle : edits.fixed)
    if (Particle* const own = find(particle)) own->fixed = true;
}

void NamedPart::end_fixed() {
  erase_numbered(scene.rods, names.rods, [&](const Rod& rod) {
    return scene.particles[rod.a].fixed && scene.particles[rod.b].fixed;
  });
  erase_numbered(scene.capsules, names.capsules,
                 [&](const Capsule& capsule) { return is_anchored(scene, capsule); });
}

std::string NamedPart::held() const {
  const auto moves = [&](std::uint32_t particle) { return !scene.particles[particle].fixed; };
  const auto moves_any = [&](const Point& point) {
    for (std::size_t k = 0; k < point.particles.size(); ++k)
      if (point.weights[k] != 0 && moves(point.particles[k])) return true;
    return false;
  };
  const auto turns_any = [&](const Direction& of) { return moves_any(of.from) || moves_any(of.to); };
  const auto find = [](const char* what, const auto& list, const Array<std::uint32_t>& numbers,
                       auto&& moves_some) {
    const auto at = std::find_if_not(list.begin(), list.end(), moves_some);
    const auto index = static_cast<std::size_t>(at - list.begin());
    return at == list.end() ? std::string{} : what + (' ' + std::to_string(numbers[index]));
  };
  const std::string found[] = {
      find("body", scene.bodies, names.bodies,
           [&](const Body& of) { return std::any_of(of.particles.begin(), of.particles.end(), moves); }),
      find("pin", scene.pins, names.pins, [&](const Pin& of) { return moves_any(of.a) || moves_any(of.b); }),
      find("alignment", scene.alignments, names.alignments,
           [&](const Alignment& of) { return turns_any(of.u) || turns_any(of.v); }),
      find("angle", scene.angles, names.angles,
           [&](const AngleControl& of) { return turns_any(of.u) || turns_any(of.v); }),
      find("spring", scene.springs, names.springs,
           [&](const Spring& of) { return moves_any(of.a) || moves_any(of.b); }),
      find("torsion", scene.torsions, names.torsions,
           [&](const Torsion& of) { return turns_any(of.axis) || turns_any(of.u) || turns_any(of.v); })};
  const auto first =
      std::find_if(std::begin(found), std::end(found), [](const std::string& each) { return !each.empty(); });
  return first == std::end(found) ? std::string{} : *first;
}

void NamedPart::end_torn_capsules(const Scene* before) {
  if (scene.capsules.empty()) return;
  const Array<std::uint32_t> are = bare_islands(scene);
  const Array<std::uint32_t> were = before ? bare_islands(*before) : Array<std::uint32_t>{};
  erase_numbered(scene.capsules, names.capsules, [&](const Capsule& capsule) {
    return joins_islands(scene, are, capsule) && !(before && joins_islands(*before, were, capsule));
  });
}

NamedPart joined(std::span<const NamedPart> parts) {
  NamedPart out;
  Names& names = out.names;
  for (std::size_t kind = 0; kind < names.kinds; ++kind) {
    Array<std::uint32_t>& all = *names.all()[kind];
    for (const NamedPart& part : parts)
      all.insert(all.end(), part.names.all()[kind]->begin(), part.names.all()[kind]->end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
  const auto place_in = [](const Array<std::uint32_t>& all, std::uint32_t number) {
    return static_cast<std::uint32_t>(std::lower_bound(all.begin(), all.end(), number) - all.begin());
  };
  for_lists([&](std::size_t kind, auto& list) { list.resize(names.all()[kind]->size()); }, out.scene);
  for (std::size_t i = parts.size(); i-- > 0;) {  // so that the first is the last to say what something is
    const NamedPart& part = parts[i];
    for_lists(
        [&](std::size_t kind, auto& to, const auto& from) {
          for (std::size_t k = 0; k < from.size(); ++k) {
            auto& item = to[place_in(*names.all()[kind], (*part.names.all()[kind])[k])] = from[k];
            for_particles(item, [&](std::uint32_t& particle) {  // places have slots that nobody reads, too
              if (particle < part.names.particles.size())
                particle = place_in(names.particles, part.names.particles[particle]);
            });
          }
        },
        out.scene, part.scene);
    for (std::size_t k = 0; k < part.scene.hulls.size(); ++k)
      out.scene.hulls[place_in(names.hulls, part.names.hulls[k])].body =
          place_in(names.bodies, part.names.bodies[part.scene.hulls[k].body]);
    out.scene.gravity = part.scene.gravity;
    out.scene.drag = part.scene.drag;
    out.scene.joint_drag = part.scene.joint_drag;
  }
  return out;
}

}  // namespace plumb::detail
