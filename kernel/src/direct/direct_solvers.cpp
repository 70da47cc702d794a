#include "direct/direct_solvers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "direct/locks/locks.hpp"
#include "direct/loops/loop_solver.hpp"
#include "direct/trees/tree_kind.hpp"
#include "direct/trees/tree_solver.hpp"
#include "interface/island_shape.hpp"
#include "plumb/layouts/trees.hpp"
#include "scene/reels/reels.hpp"

namespace plumb::detail {
namespace {

using layouts::lane_width;

/// Rods that start off their length by less than this share do so by the rounding of their coordinates.
constexpr double least_gap = 1e-9;

/// Returns the elements of an island.
LoopElements local_elements(const Scene& scene, const IslandSets& sets, std::uint32_t island) {
  LoopElements out;
  if (!sets.elements.any_of(island)) return out;
  const auto vertices = sets.islands.vertices(island);
  const auto fixed = std::find_if(vertices.begin(), vertices.end(),
                                  [&](std::uint32_t i) { return scene.particles[i].fixed; });
  const auto place = [&](std::uint32_t particle) {
    const bool is_fixed = scene.particles[particle].fixed;
    const auto at =
        std::lower_bound(is_fixed ? fixed : vertices.begin(), is_fixed ? vertices.end() : fixed, particle);
    return static_cast<std::uint32_t>(at - vertices.begin());
  };
  for (const std::uint32_t i : sets.elements.bends_of(island)) {
    const Bend& bend = scene.bends[i];
    out.bends.push_back({{place(bend.a), place(bend.b), place(bend.c)}});
  }
  std::uint32_t segments = 0;
  for (const std::uint32_t i : sets.elements.tackles_of(island)) {
    const std::uint32_t pulleys = out.pulleys();
    LoopTackle& tackle = out.tackles.emplace_back();
    tackle.first = segments;
    tackle.first_pulley = pulleys;
    tackle.rubs = scene.tackles[i].friction > 0;
    for (const std::uint32_t particle : scene.tackles[i].particles)
      tackle.vertices.push_back(place(particle));
    segments += tackle.segments();
  }
  for (const std::uint32_t i : sets.elements.twists_of(island)) {
    LoopTwist& twist = out.twists.emplace_back();
    for (const std::uint32_t particle : scene.twists[i].particles) twist.vertices.push_back(place(particle));
  }
  if (sets.elements.reels_of(island).empty()) return out;
  const RodTable rods(scene);
  const auto edges = sets.islands.edges(island);
  for (const std::uint32_t i : sets.elements.reels_of(island)) {
    LoopReel& reel = out.reels.emplace_back();
    for (const std::uint32_t particle : scene.reels[i].particles) reel.vertices.push_back(place(particle));
    for (const std::uint32_t rod : rods_of(rods, scene.reels[i]))
      reel.rods.push_back(
          static_cast<std::uint32_t>(std::lower_bound(edges.begin(), edges.end(), rod) - edges.begin()));
  }
  return out;
}

/// Says whether fixed points may hold a node other than the root for good, by three ties or, in a plane, by
/// two. Elimination from the tips would divide by zero at its rod to the parent; the solver for loops does
/// not.
bool is_held_below_root(const layouts::Tree& tree) {
  for (std::uint32_t i = 1; i < tree.nodes(); ++i)
    if (tree.tie_begin[i + 1] - tree.tie_begin[i] > 1) return true;
  return false;
}

class Maker {
 public:
  Maker(const Scene& scene, const IslandSets& sets, const Settings& settings, const DirectRules& rules,
        StartReport& report)
      : scene_(scene),
        sets_(sets),
        settings_(settings),
        rules_(rules),
        report_(report),
        bends_(scene),
        reeled_(reeled_rods(scene)) {}

  Array<MadeSolver> make() {
    for (const Array<std::uint32_t>& alike : sets_.sets) {
      Array<std::uint32_t> equal;
      std::map<LoopElements, Array<std::uint32_t>> others;
      for (const std::uint32_t island : alike)
        if (const LoopElements elements = local_elements(scene_, sets_, island); elements.any())
          others[elements].push_back(island);
        else
          equal.push_back(island);
      for (const auto& [elements, islands] : others) add_with_elements(islands, elements);
      if (equal.empty()) continue;
      const layouts::LocalGraph local = layouts::local_graph(sets_.graph, sets_.islands, equal.front());
      const auto tree = report_.kinds->tree_of(local);
      if (tree && tree->ties.size() > 1) add_locked(equal, local.view());
      if (equal.empty()) continue;
      if (!tree || is_held_below_root(*tree))
        add_loops(equal, local.view(), {});
      else if (rules_.precision == Precision::double_)
        add_trees<double>(equal, *tree);
      else
        add_trees<float>(equal, *tree);
    }
    return std::move(made_);
  }

 private:
  MassModel model() const { return mass_model_of(settings_); }
  Isa isa() const { return settings_.isa.value_or(best_isa()); }

  bool is_off_length(std::uint32_t island) const {
    for (const std::uint32_t i : sets_.elements.tackles_of(island))
      if (is_off(scene_.tackles[i])) return true;
    for (const std::uint32_t i : sets_.elements.reels_of(island))
      if (is_off(scene_.reels[i])) return true;
    for (const std::uint32_t i : sets_.islands.edges(island)) {
      const Rod& rod = scene_.rods[i];
      const bool is_reeled = !reeled_.empty() && reeled_[i] != 0;
      if (!is_reeled && is_off(rod.law, distance(rod.a, rod.b), rod_length(scene_, i))) return true;
    }
    return false;
  }

  static bool is_off(const RodLaw& law, double now, double length) {
    if (law.is_elastic() || (law.one_sided && now < length)) return false;
    return std::abs(now - length) > least_gap * length;
  }

  double distance(std::uint32_t a, std::uint32_t b) const {
    return norm(scene_.particles[b].position - scene_.particles[a].position);
  }

  bool is_off(const Tackle& tackle) const {
    double now = 0;
    for (std::size_t k = 1; k < tackle.particles.size(); ++k)
      now += distance(tackle.particles[k - 1], tackle.particles[k]);
    return tackle.length != 0 && is_off(tackle.law, now, tackle.length);
  }

  /// Of a chain that is what is out.
  bool is_off(const Reel& reel) const {
    const RodTable table(scene_);
    const ReelStart start = start_of(scene_, table, reel);
    const Array<std::uint32_t> rods = rods_of(table, reel);
    const auto& particles = reel.particles;
    bool off = is_off(scene_.rods[rods[start.first - 1]].law,
                      distance(particles.front(), particles[start.first]), start.leaving());
    for (std::size_t k = start.first; k < rods.size(); ++k)
      off = off || is_off(scene_.rods[rods[k]].law, distance(particles[k], particles[k + 1]),
                          rod_length(scene_, rods[k]));
    return off;
  }

  /// Says whether rigid rods hold a line straight between its two anchors, which the solver for loops knows.
  bool is_locked(std::uint32_t island, const layouts::Tree& line) const {
    if (line.ties.size() != 2) return false;
    double length = 0;
    for (const std::uint32_t rod : sets_.islands.edges(island)) {
      if (scene_.rods[rod].law.is_elastic()) return false;
      length += rod_length(scene_, rod);
    }
    const auto vertices = sets_.islands.vertices(island);
    return is_taut(length, distance(vertices[line.ties[0].vertex], vertices[line.ties[1].vertex]));
  }

  /// Adds equal islands with elements. Lines with bends and a twist alone are trees, in double.
  void add_with_elements(const Array<std::uint32_t>& equal, const LoopElements& elements) {
    const layouts::LocalGraph local = layouts::local_graph(sets_.graph, sets_.islands, equal.front());
    const bool may_break = std::any_of(equal.begin(), equal.end(), [&](std::uint32_t island) {
      const auto rods = sets_.islands.edges(island);
      return std::any_of(rods.begin(), rods.end(), [&](std::uint32_t i) {
        return scene_.rods[i].law.strength < std::numeric_limits<double>::infinity();
      });
    });
    const auto tree = may_break ? std::nullopt : layouts::find_tree(local.view());
    const auto bends = tree ? find_line_bends(*tree, elements) : std::nullopt;
    if (bends && std::none_of(equal.begin(), equal.end(),
                              [&](std::uint32_t island) { return is_locked(island, *tree); }))
      add_trees<double>(equal, *tree, *bends);
    else
      add_loops(equal, local.view(), elements);
  }

  /// Adds the islands that have rigid lines straight between anchors, and takes them from `equal`. No pull
  /// holds such a line, which the solver for loops knows (Locks).
  void add_locked(Array<std::uint32_t>& equal, const layouts::Graph& local) {
    const auto topology = std::make_shared<LoopTopology>(local);
    Array<std::uint32_t> locked;
    std::erase_if(equal, [&](std::uint32_t island) {
      const bool is_locked = find_locks(state_of(topology, island)).any();
      if (is_locked) locked.push_back(island);
      return is_locked;
    });
    if (!locked.empty()) add_loops(locked, local, {});
  }

  /// Returns the state of an island whose topology has these vertices.
  LoopState state_of(const std::shared_ptr<const LoopTopology>& topology, std::uint32_t island) const {
    Array<std::uint32_t> vertices;
    for (const std::uint32_t i : topology->order) vertices.push_back(sets_.islands.vertices(island)[i]);
    return {topology, scene_, model(), vertices, sets_.islands.edges(island)};
  }

  template <class T>
  void add_trees(const Array<std::uint32_t>& equal, const layouts::Tree& tree, const LineBends& bends = {}) {
    const auto count = static_cast<std::uint32_t>(equal.size());
    // With fewer trees than this a whole vector would cost more than one tree after the other.
    const std::uint32_t lanes = count * 4 >= lane_width<T> ? lane_width<T> : 1;
    const auto kind = report_.kinds->get<T>(
        tree, lanes,
        typename TreeKind<T>::Rules{rules_.gradient, rules_.time_order, settings_.accuracy.has_value(),
                                    rules_.changes_gradient, rules_.bounds_frames && !bends.any(),
                                    scene_.drag, isa(), settings_.threads},
        bends);
    for (std::uint32_t first = 0; first < count; first += lanes)
      add_lane_group<T>(kind, tree, std::span(equal).subspan(first, std::min(lanes, count - first)));
  }

  template <class T>
  void add_lane_group(const std::shared_ptr<TreeKind<T>>& kind, const layouts::Tree& tree,
                      std::span<const std::uint32_t> equal) {
    const auto trees = static_cast<std::uint32_t>(equal.size());
    auto solver = std::make_unique<TreeSolver<T>>(kind, trees);
    const auto members_of = [&](std::uint32_t lane) {
      const std::uint32_t island = equal[std::min(lane, trees - 1)];
      return TreeMembers{sets_.islands.vertices(island), sets_.islands.edges(island)};
    };
    for (std::uint32_t lane = 0; lane < kind->lanes; ++lane)
      solver->fill_lane(lane, scene_, model(), tree, members_of(lane));
    const LineBends& bends = kind->topology->bends;
    for (std::uint32_t lane = 0; bends.any() && lane < kind->lanes; ++lane)
      solver->fill_bends(lane, bends_, sets_.elements.bends_of(equal[std::min(lane, trees - 1)]));
    for (std::uint32_t lane = 0; bends.is_twisted() && lane < kind->lanes; ++lane)
      solver->fill_twist(lane, bends_, sets_.elements.twists_of(equal[std::min(lane, trees - 1)]).front());
    solver->finish_layout(!scene_.capsules.empty() || !scene_.hulls.empty());
    MadeSolver made;
    made.places.reserve(std::size_t{trees} * (kind->topology->nodes + kind->topology->ties));
    made.cords.reserve(std::size_t{trees} * kind->topology->rods());
    for (std::uint32_t lane = 0; lane < trees; ++lane) {
      const auto vertices = members_of(lane).vertices;
      const auto rods = members_of(lane).edges;
      for (std::uint32_t i = 0; i < tree.nodes(); ++i) {
        made.places.push_back({vertices[tree.vertex[i]], solver->node_slot(i, lane)});
        if (i > 0) made.cords.push_back({rods[tree.edge[i]], solver->rod_slot(i, lane)});
      }
      for (std::uint32_t k = 0; k < tree.ties.size(); ++k) {
        made.places.push_back({vertices[tree.ties[k].vertex], solver->tie_slot(k, lane)});
        made.cords.push_back({rods[tree.ties[k].edge], solver->tie_slot(k, lane)});
      }
      for (std::uint32_t c = 0; c < bends.clamps.size(); ++c)
        made.places.push_back({vertices[bends.clamps[c]],
                               solver->tie_slot(static_cast<std::uint32_t>(tree.ties.size()) + c, lane)});
      for (const std::uint32_t twist : sets_.elements.twists_of(equal[lane]))
        made.twists.emplace_back(twist, lane);
    }
    start(*solver, equal, made);
    if (settings_.tensions) solver->count_pulls();
    made.solver = std::move(solver);
    made_.push_back(std::move(made));
  }

  void add_loops(const Array<std::uint32_t>& equal, const layouts::Graph& local,
                 const LoopElements& elements) {
    if (!loop_rules_) {
      loop_rules_ = std::make_shared<LoopRules>(rules_.gradient, rules_.time_order, scene_.drag,
                                                settings_.accuracy, isa());
      loop_rules_->set_stop_rule(settings_.stop);
      if (rules_.bounds_frames) loop_rules_->stepper.bound_frames();
    }
    const bool couples = std::any_of(equal.begin(), equal.end(), [&](std::uint32_t island) {
      return carries_mass(scene_, sets_.islands.edges(island), model());
    });
    const auto topology = std::make_shared<LoopTopology>(local, elements);
    const bool gives = elements.any() || std::any_of(equal.begin(), equal.end(), [&](std::uint32_t island) {
                         return has_laws(scene_, sets_.islands.edges(island));
                       });
    const bool all_give =
        !elements.any() && std::all_of(equal.begin(), equal.end(), [&](std::uint32_t island) {
          return all_elastic(scene_, sets_.islands.edges(island));
        });
    if (!couples && all_give && !is_thin(local)) {
      topology->use_net();
    } else if (couples || gives || is_thin(local)) {
      topology->system = std::make_unique<LoopSystem>(
          topology->rods, topology->nodes, LoopStepper::couples(rules_.gradient, model()), elements);
    } else {
      Array<Vec3> positions;
      for (const std::uint32_t vertex : sets_.islands.vertices(equal.front()))
        positions.push_back(scene_.particles[vertex].position);
      topology->use_lines(positions);
    }
    for (const std::uint32_t island : equal) {
      MadeSolver made;
      for (const std::uint32_t i : topology->order)
        made.places.push_back({sets_.islands.vertices(island)[i], static_cast<Slot>(made.places.size())});
      const auto rods = sets_.islands.edges(island);
      Slot cord = 0;
      for (const std::uint32_t rod : rods) made.cords.push_back({rod, cord++});
      for (const std::uint32_t tackle : sets_.elements.tackles_of(island))
        made.cords.push_back({static_cast<std::uint32_t>(scene_.rods.size()) + tackle, cord++});
      for (const std::uint32_t reel : sets_.elements.reels_of(island))
        made.cords.push_back(
            {static_cast<std::uint32_t>(scene_.rods.size() + scene_.tackles.size()) + reel, cord++});
      LoopState state = state_of(topology, island);
      if (elements.any()) load_elements(state, island, made);
      auto solver = std::make_unique<LoopSolver>(loop_rules_, std::move(state));
      start(*solver, std::span(&island, 1), made);
      if (settings_.tensions) solver->count_pulls();
      made.solver = std::move(solver);
      made_.push_back(std::move(made));
    }
  }

  void load_elements(LoopState& state, std::uint32_t island, MadeSolver& made) const {
    const IslandRods rods(state.topology->rods);
    state.hold.resize(state.fixed_velocity.size());
    load_bends(state, bends_, rods, sets_.elements.bends_of(island));
    load_tackles(state, scene_, sets_.elements.tackles_of(island));
    load_twists(state, bends_, rods, sets_.elements.twists_of(island));
    load_reels(state, scene_, sets_.elements.reels_of(island));
    for (const std::uint32_t twist : sets_.elements.twists_of(island))
      made.twists.emplace_back(twist, static_cast<Slot>(made.twists.size()));
  }

  /// Positions come first, before there are velocities.
  template <class AnySolver>
  void start(AnySolver& solver, std::span<const std::uint32_t> islands, const MadeSolver& made) {
    if (report_.goes_on) return;
    if (std::any_of(islands.begin(), islands.end(), [&](std::uint32_t i) { return is_off_length(i); })) {
      report_.unprojected_islands += solver.project_positions();
      for (const auto& [particle, slot] : made.places)
        report_.projected_position = std::max(
            report_.projected_position, norm(solver.position(slot) - scene_.particles[particle].position));
    }
    for (const auto& [particle, slot] : made.places)
      if (!scene_.particles[particle].fixed) solver.set_velocity(slot, scene_.particles[particle].velocity);
    solver.project_velocities();
    for (const auto& [particle, slot] : made.places)
      if (!scene_.particles[particle].fixed)
        report_.projected_velocity = std::max(
            report_.projected_velocity, norm(solver.velocity(slot) - scene_.particles[particle].velocity));
  }

  const Scene& scene_;
  const IslandSets& sets_;
  const Settings& settings_;
  const DirectRules& rules_;
  StartReport& report_;
  const BendTable bends_;
  const Array<std::uint8_t> reeled_;
  std::shared_ptr<LoopRules> loop_rules_;
  Array<MadeSolver> made_;
};

}  // namespace

Array<MadeSolver> make_direct_solvers(const Scene& scene, const IslandSets& sets, const Settings& settings,
                                      const DirectRules& rules, StartReport& report) {
  return Maker(scene, sets, settings, rules, report).make();
}

}  // namespace plumb::detail
