// This file brings islands of the contact solver together.

#include <algorithm>
#include <set>
#include <span>

#include "contact/contact_solver.hpp"

namespace plumb::detail {
namespace {

/// Lets parts stand as they do in a whole scene. Each stood where the first one of its kind did, and so did
/// what bodies and hulls tell in the axes of space.
void stand_as_in(const Scene& whole, NamedPart& part) {
  Scene& scene = part.scene;
  const Names& names = part.names;
  for (std::size_t k = 0; k < scene.particles.size(); ++k)
    scene.particles[k].position = whole.particles[names.particles[k]].position;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    scene.bodies[k].center = whole.bodies[names.bodies[k]].center;
    scene.bodies[k].inertia = whole.bodies[names.bodies[k]].inertia;
  }
  for (std::size_t k = 0; k < scene.hulls.size(); ++k)
    scene.hulls[k].points = whole.hulls[names.hulls[k]].points;
}

/// Projects velocities while anchors and wound rods go on as they went in the last substep.
void project_as_it_went(LinkageState& state, ProjectionWork& work) {
  const std::span<Vec3> anchors = std::span(state.v).subspan(state.linkage->movable());
  std::copy(state.anchors_went.begin(), state.anchors_went.end(), anchors.begin());
  state.lengths.follow_last();
  project_velocities(state, work);
  std::fill(anchors.begin(), anchors.end(), Vec3{});
  state.lengths.follow(0);
}

}  // namespace

auto ContactSolver::make_met(Meeting of) -> Array<Made> {
  Array<std::uint32_t> homes = of.homes.names.particles;
  std::sort(homes.begin(), homes.end());
  Array<NamedPart> plain, parts;
  std::set<std::uint32_t> visiting;
  Met met;
  for (const std::uint32_t island : of.islands) {
    clusters_.wake(island);  // and what lies on it
    const LinkageState& state = states_[island];
    NamedPart part = named_part(island);
    if (!visitors_[island].is_at_home())
      visiting.insert(part.names.particles.begin(), part.names.particles.end());
    for (std::uint32_t k = 0; k < part.names.particles.size(); ++k)
      if (k >= state.linkage->movable() || is_plain_[island] == 0)
        met.were.try_emplace(part.names.particles[k], island, k);
    if (is_plain_[island] != 0) {
      part.refix(of.edits);  // first, as in edit()
      for (const std::uint32_t rod : of.edits.cut) part.cut(rod, of.edits);
      plain.push_back(std::move(part));
    } else {
      edit(part, of.edits);
      parts.push_back(std::move(part));
    }
  }
  plain.insert(plain.begin(), {std::move(of.others), std::move(of.homes)});
  NamedPart simple = joined(plain);
  simple.end_fixed();
  simple.end_torn_capsules(nullptr);
  for (std::size_t k = 0; k < simple.names.particles.size(); ++k)
    met.now.emplace(simple.names.particles[k], simple.scene.particles[k]);
  for (std::size_t k = 0; k < of.joints.names.particles.size(); ++k)
    if (of.joints.scene.particles[k].fixed)
      met.now.emplace(of.joints.names.particles[k], of.joints.scene.particles[k]);
  parts.push_back(std::move(simple));
  parts.push_back(std::move(of.joints));
  NamedPart all = joined(parts);
  stand_as_in(of.began, all);
  for (std::size_t k = 0; k < all.names.particles.size(); ++k) {
    Particle& particle = all.scene.particles[k];
    if (const auto now = met.now.find(all.names.particles[k]); now != met.now.end()) {
      particle.fixed = now->second.fixed;
      particle.mass = now->second.mass;
    }
  }
  all.end_fixed();
  Array<Made> out;
  const auto goes_home = [&](const SceneParts& part_list, std::uint32_t p) {
    return std::binary_search(homes.begin(), homes.end(),
                              all.names.particles[part_list.particles(p).front()]);
  };
  replace(of.islands, all, goes_home, [&](const SceneParts& part_list, std::uint32_t p, LinkageState& state) {
    begin_met(met, all.names.particles, part_list.particles(p), state);
    copy_laws(all, part_list, p, state, false);
    const auto movable = std::span(state.particles).first(state.linkage->movable());
    out.push_back({state.number, std::any_of(movable.begin(), movable.end(), [&](std::uint32_t particle) {
                     return visiting.contains(particle);
                   })});
  });
  return out;
}

/// Lets an island that came together go on as its particles did, which it has in this order.
void ContactSolver::begin_met(const Met& met, std::span<const std::uint32_t> names,
                              std::span<const std::uint32_t> order, LinkageState& state) const {
  const std::uint32_t movable = state.linkage->movable();
  state.asleep = false;
  state.gradient = gradients_.of(*state.linkage, is_plain_[state.number] != 0);
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    const std::uint32_t particle = names[order[k]];
    state.particles.push_back(particle);
    const auto now = met.now.find(particle);
    const auto at = met.were.find(particle);
    const LinkageState* const from = at == met.were.end() ? nullptr : &states_[at->second.first];
    const std::uint32_t old = from ? at->second.second : 0;
    const bool has_moved = from && old < from->linkage->movable();
    if (has_moved) {
      state.x[k] = from->x[old];
      state.frozen = state.frozen || from->frozen;
      state.on_ground = state.on_ground || from->on_ground;
      state.is_relaxed = state.is_relaxed || from->is_relaxed;
      state.strain = std::max(state.strain, from->strain);
      state.relax_for = std::max(state.relax_for, from->relax_for);
    } else if (now != met.now.end()) {
      state.x[k] = now->second.position;
    }
    if (k < movable && has_moved) {
      state.v[k] = from->v[old];
      state.force[k] = from->force[old];
      state.acceleration[k] = from->acceleration[old];
    } else if (k < movable) {
      state.v[k] = now->second.velocity;
    } else if (!has_moved) {
      state.anchors_went[k - movable] = from ? from->anchors_went[old - from->linkage->movable()]
                                        : now != met.now.end() ? now->second.velocity
                                                               : Vec3{};
    }
  }
}

std::string ContactSolver::held_by(Slot slot, std::span<const std::uint8_t> is_fixed) const {
  NamedPart part = named_part(island_of_[slot]);
  const std::uint32_t particle = part.names.particles[local(slot)];
  for (std::size_t k = 0; k < part.names.particles.size(); ++k) {
    const std::uint32_t each = part.names.particles[k];
    part.scene.particles[k].fixed = each == particle || is_fixed[each] != 0;
  }
  return part.held();
}

/// What sweeps move is solved this once, since they would make a bounce of a blow.
void ContactSolver::project_edited_velocities(std::uint32_t island) {
  LinkageState& state = states_[island];
  if (!relaxes_) return project_as_it_went(state, work_);
  const Scene part = named_part(island).scene;
  const Linkage solved(part, isa_, Linkage::Use::solved);
  LinkageState alike(solved, island, part, false);
  alike.x = state.x;
  alike.v = state.v;
  alike.anchors_went = state.anchors_went;
  alike.lengths = state.lengths;
  project_as_it_went(alike, work_);
  state.v = alike.v;
}

}  // namespace plumb::detail
