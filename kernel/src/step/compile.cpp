#include <algorithm>
#include <array>

#include "direct/direct_solvers.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/trees.hpp"
#include "scene/scene_graph.hpp"
#include "step/choose_method.hpp"
#include "step/compiled.hpp"
#include "step/methods.hpp"

namespace plumb::detail {
namespace {

/// How an island is moved.
struct Choice {
  Method method = Method::relax;
  DirectRules direct{};  ///< of method direct

  bool operator==(const Choice&) const = default;
};

/// Islands that are moved alike.
struct Share {
  Choice choice;
  std::vector<std::vector<std::uint32_t>> groups;  ///< those with equal graphs together
};

Choice choose(const Scene& scene, const layouts::Graph& island, std::span<const std::uint32_t> rods,
              const Settings& settings) {
  if (settings.method != Method::automatic)
    return {settings.method, {gradient_of(settings), settings.time_order, false}};
  const bool is_tree = layouts::find_tree(island).has_value();
  Choice out{choose_method(scene, is_tree || is_thin(island), rods, settings), {}};
  if (out.method != Method::direct) return out;
  out.direct.gradient = choose_gradient(scene, is_tree, rods, settings);
  out.direct.time_order = choose_time_order(out.direct.gradient, is_tree, rods.size(), settings);
  out.direct.changes_gradient = settings.accuracy && !settings.gradient &&
                                out.direct.gradient == Gradient::old && out.direct.time_order == 2;
  return out;
}

class Compiler {
 public:
  Compiler(const Scene& scene, const Settings& settings)
      : scene_(scene), settings_(settings), scene_graph_(scene), graph_(scene_graph_.view()) {}

  Compiled make() {
    if (is_articulated(scene_))
      add_contact();
    else
      add_islands();
    place_particles();
    fill_info();
    return std::move(out_);
  }

 private:
  void add_contact() {
    MadeSolver made = make_contact_solver(scene_, settings_, start_);
    out_.contact = static_cast<ContactSolver*>(made.solver.get());
    out_.info.islands = out_.contact->island_count();
    add(std::move(made));
  }

  void add_islands() {
    const layouts::Islands islands = layouts::find_islands(graph_);
    out_.info.islands = islands.count();
    bool is_first = true;
    for (const Share& share : shares_of(islands)) {
      const IslandGroups groups{graph_, islands, share.groups};
      if (share.choice.method != Method::direct) {
        for (MadeSolver& made : method_row(share.choice.method).make(scene_, groups, settings_, start_))
          add(std::move(made));
        continue;
      }
      for (MadeSolver& made : make_direct_solvers(scene_, groups, settings_, share.choice.direct, start_))
        add(std::move(made));
      if (is_first) {
        out_.info.direct_gradient = share.choice.direct.gradient;
        out_.info.direct_time_order = share.choice.direct.time_order;
      }
      is_first = false;
    }
  }

  std::vector<Share> shares_of(const layouts::Islands& islands) const {
    std::vector<Share> shares;
    for (const auto& equal : layouts::group_equal_islands(graph_, islands)) {
      const layouts::LocalGraph local = layouts::local_graph(graph_, islands, equal.front());
      std::vector<std::size_t> joined;  // shares that this group's islands went to
      for (const std::uint32_t island : equal) {
        const Choice choice = choose(scene_, local.view(), islands.edges(island), settings_);
        auto share = std::find_if(shares.begin(), shares.end(),
                                  [&](const Share& each) { return each.choice == choice; });
        if (share == shares.end()) share = shares.insert(shares.end(), {choice, {}});
        const auto number = static_cast<std::size_t>(share - shares.begin());
        if (std::find(joined.begin(), joined.end(), number) == joined.end()) {
          joined.push_back(number);
          share->groups.emplace_back();
        }
        share->groups.back().push_back(island);
      }
    }
    return shares;
  }

  void add(MadeSolver made) {
    slots_.push_back(std::move(made.places));
    out_.solvers.push_back(std::move(made.solver));
  }

  void place_particles() {
    std::vector<Places::Entry> entries;
    for (std::uint32_t s = 0; s < slots_.size(); ++s)
      for (const auto& [particle, slot] : slots_[s]) entries.push_back({particle, {s, slot}});
    out_.places = Places(static_cast<std::uint32_t>(scene_.particles.size()), entries);
  }

  void fill_info() {
    WorldInfo& info = out_.info;
    info.particles = static_cast<std::uint32_t>(scene_.particles.size());
    info.rods = static_cast<std::uint32_t>(scene_.rods.size());
    info.isa = settings_.isa.value_or(best_isa());
    info.threads = settings_.threads;
    info.skipped_drag = scene_.drag == 0;
    info.projected_velocity = start_.projected_velocity;
    info.projected_position = start_.projected_position;
    info.unprojected_islands = start_.unprojected_islands;
    for (const auto& solver : out_.solvers) solver->describe(info);
  }

  const Scene& scene_;
  const Settings& settings_;
  const SceneGraph scene_graph_;
  const layouts::Graph graph_;
  Compiled out_;
  StartReport start_;
  std::vector<std::vector<MadeSolver::Place>> slots_;  ///< by solver
};

}  // namespace

Compiled compile(const Scene& scene, const Settings& settings) {
  return Compiler(scene, settings).make();
}

}  // namespace plumb::detail
