#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/shapes/hulls/convex_hull.hpp"
#include "direct/direct_solvers.hpp"
#include "direct/trees/tree_kind.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/trees.hpp"
#include "scene/bends/bends.hpp"
#include "scene/bends/bent_islands.hpp"
#include "scene/bends/rod_table.hpp"
#include "scene/refuse.hpp"
#include "scene/scene_graph.hpp"
#include "step/compile/choose_method.hpp"
#include "step/compile/compiled.hpp"
#include "step/compile/requirements.hpp"
#include "step/methods.hpp"

namespace plumb::detail {
namespace {

/// Lists the islands that are moved alike.
struct Share {
  Choice choice;
  Array<Array<std::uint32_t>> sets;  ///< island numbers; islands of equal graphs share a set
};

class Compiler {
 public:
  Compiler(const Scene& scene, const Settings& settings)
      : scene_(scene),
        settings_(settings),
        scene_graph_(scene),
        graph_(scene_graph_.view()),
        is_jointed_(scene.particles.size(), 0),
        islands_(find_bent_islands(scene, graph_)),
        elements_(scene, islands_) {}

  Compiled make(const std::shared_ptr<const Scene>& whole) {
    require_laws_moved(scene_, settings_);
    require_springs_moved(scene_, settings_.method);
    if (needs_contact_stage(scene_)) make_contact(whole);
    require_elements_moved();
    const Array<Share> shares = shares_of(islands_);
    if (settings_.method == Method::automatic) require_settings_read(shares);
    Compiled out = make_from(shares);
    if (!reads_stop_rule(out)) require_tolerance_read(settings_);
    return out;
  }

  Compiled make_parts(const Compiled& whole) {
    start_ = {.goes_on = true, .relaxed_rods = whole.info.relaxed_rods, .kinds = whole.kinds};
    return make_from(shares_of(islands_));
  }

  Compiled make_addition(const Compiled& whole) {
    require_laws_moved(scene_, settings_);
    require_springs_moved(scene_, settings_.method);
    if (needs_contact_stage(scene_)) leave_to_contact(whole);
    require_elements_moved();
    start_ = {.relaxed_rods = whole.info.relaxed_rods, .kinds = whole.kinds};
    return make_from(shares_of(islands_));
  }

 private:
  /// Returns whether a solver reads the rule that it was made with.
  bool reads_stop_rule(const Compiled& compiled) const {
    bool is_read = false;
    for (const auto& solver : compiled.solvers) is_read = solver->set_stop_rule(settings_.stop) || is_read;
    return is_read;
  }

  void make_contact(const std::shared_ptr<const Scene>& whole) {
    const SceneParts parts(scene_);
    if (method_row(settings_.method).make_jointed) return make_jointed(parts);
    contact_ = std::make_unique<ContactSolver>(whole, parts, settings_);
    find_jointed(parts);
    start_.projected_velocity = contact_->project_initial_velocities();
    out_.info.direct_gradient = settings_.gradient.value_or(Gradient::old);
  }

  /// Finds which particles belong to islands that the contact solver alone can move. Returns a particle of
  /// the first island that it knows, if there is one.
  std::optional<std::uint32_t> find_jointed(const SceneParts& parts) {
    std::optional<std::uint32_t> first;
    for (std::uint32_t p = 0; p < parts.count(); ++p) {
      const Scene part = parts.part(p);
      const bool plain = is_plain(part);
      if (plain && part.capsules.empty()) continue;
      if (!first) first = parts.particles(p).front();
      require_no_elements(parts.particles(p));
      if (plain) continue;
      require_joints_moved(part, parts.particles(p), settings_);
      leave_out(parts.particles(p));
    }
    return first;
  }

  /// Finds likewise what an addition leaves to the world's contact solver.
  void leave_to_contact(const Compiled& whole) {
    const std::optional<std::uint32_t> first = find_jointed(SceneParts(scene_));
    if (first && !whole.contact)
      refuse("particle ", *first,
             ": its island has shapes, bodies, joints, air or sleepers, which cannot be added to a ",
             "world that began without them and without ground");
    out_.needs_contact = first.has_value();
    // A hull whose surface rounding leaves open is refused now, while nothing has changed.
    for (const Hull& hull : scene_.hulls) static_cast<void>(ConvexHull(hull.points));
  }

  /// Makes solvers for islands with bodies or joints by a method that needs no contact solver for them.
  void make_jointed(const SceneParts& parts) {
    for (std::uint32_t p = 0; p < parts.count(); ++p) {
      const Scene part = parts.part(p);
      if (!part.capsules.empty() || !part.hulls.empty())
        refuse("particle ", parts.particles(p).front(), ": its island has shapes, and method ",
               to_string(settings_.method), " lets nothing touch; ",
               methods_that([](const MethodRow& row) { return row.moves_joints; }), " do");
      if (is_plain(part)) continue;
      require_no_elements(parts.particles(p));
      leave_out(parts.particles(p));
      add(method_row(settings_.method).make_jointed(part, parts.particles(p), settings_, start_));
    }
  }

  /// Leaves an island to what moves joints.
  void leave_out(std::span<const std::uint32_t> particles) {
    ++out_.info.islands;
    for (const std::uint32_t particle : particles)
      if (!scene_.particles[particle].fixed) is_jointed_[particle] = 1;
  }

  /// Refuses elements in an island with joints or shapes, but for bends.
  void require_no_elements(std::span<const std::uint32_t> particles) {
    if (scene_.tackles.empty() && scene_.twists.empty() && scene_.reels.empty()) return;
    if (element_at_.empty()) find_elements();
    for (const std::uint32_t particle : particles)
      if (!scene_.particles[particle].fixed && element_at_[particle].name)
        refuse(element_at_[particle].name, " ", element_at_[particle].number,
               ": its island has joints or shapes, which nothing moves together with it yet");
  }
  void find_elements() {
    element_at_.assign(scene_.particles.size(), Named{nullptr, 0});
    const auto mark = [&](const char* name, std::size_t i, std::span<const std::uint32_t> particles) {
      for (const std::uint32_t particle : particles)
        if (!element_at_[particle].name) element_at_[particle] = {name, i};
    };
    for (std::size_t i = 0; i < scene_.tackles.size(); ++i) mark("tackle", i, scene_.tackles[i].particles);
    for (std::size_t i = 0; i < scene_.twists.size(); ++i) mark("twist", i, scene_.twists[i].particles);
    for (std::size_t i = 0; i < scene_.reels.size(); ++i) mark("reel", i, scene_.reels[i].particles);
  }

  /// Refuses elements where the method or the gradient does not know them.
  void require_elements_moved() const {
    constexpr const char* straight = ": a straight chain has no direction at the old position";
    const auto is_alone = [&](const Bend& bend) {
      const auto of = particles_of(bend);
      return std::none_of(of.begin(), of.end(), [&](std::uint32_t i) { return is_jointed_[i] != 0; });
    };
    const auto bend = std::find_if(scene_.bends.begin(), scene_.bends.end(), is_alone);
    if (bend != scene_.bends.end())
      require_moved("bend", static_cast<std::size_t>(bend - scene_.bends.begin()), straight);
    if (!scene_.tackles.empty()) require_moved("tackle", 0, "");
    if (!scene_.twists.empty()) require_moved("twist", 0, straight);
    if (!scene_.reels.empty()) require_moved("reel", 0, "");
  }
  void require_moved(const char* name, std::size_t i, const char* why) const {
    require_element_moved(settings_, name, i, why);
  }

  /// Refuses settings of relaxation if method automatic relaxes no island.
  void require_settings_read(std::span<const Share> shares) const {
    const auto is_relaxed = [](const Share& share) { return share.choice.method == Method::relax; };
    if (std::none_of(shares.begin(), shares.end(), is_relaxed))
      require_read_by_direct(settings_, contact_ != nullptr);
  }

  Compiled make_from(std::span<const Share> shares) {
    add_islands(shares);
    if (contact_) add_contact();
    place_particles();
    fill_info();
    return std::move(out_);
  }

  void add_islands(std::span<const Share> shares) {
    bool is_first = true;
    for (const Share& share : shares) {
      const IslandSets sets{graph_, islands_, share.sets, elements_};
      if (share.choice.method != Method::direct) {
        for (MadeSolver& made : method_row(share.choice.method).make(scene_, sets, settings_, start_))
          add(std::move(made));
        continue;
      }
      for (MadeSolver& made : make_direct_solvers(scene_, sets, settings_, share.choice.direct, start_))
        add(std::move(made));
      if (is_first) {
        out_.info.direct_gradient = share.choice.direct.gradient;
        out_.info.direct_time_order = share.choice.direct.time_order;
      }
      is_first = false;
    }
  }

  /// The contact solver is added last, so that its place of a particle is the particle's last one.
  void add_contact() {
    Array<std::pair<std::uint32_t, Slot>> home(scene_.particles.size(), {none, 0});
    for (std::uint32_t s = 0; s < slots_.size(); ++s)
      for (const auto& [particle, slot] : slots_[s])
        if (home[particle].first == none) home[particle] = {s, slot};
    for (const auto& [island, particles, movable] : contact_->plain_islands()) {
      Array<Slot> at_home;
      for (std::uint32_t k = 0; k < movable; ++k) at_home.push_back(home[particles[k]].second);
      const std::uint32_t number = home[particles.front()].first;
      contact_->set_home(island, *out_.solvers[number], number, std::move(at_home));
    }
    out_.contact = contact_.get();
    slots_.push_back(contact_->places());
    out_.solvers.push_back(std::move(contact_));
  }

  Array<Share> shares_of(const layouts::Islands& islands) {
    Array<Share> shares;
    std::vector<double> masses;
    if (settings_.precision == Precision::single) masses = lumped_masses(scene_);
    for (const auto& equal : layouts::group_equal_islands(graph_, islands)) {
      layouts::LocalGraph local;  // which method automatic alone looks at
      if (settings_.method == Method::automatic) local = layouts::local_graph(graph_, islands, equal.front());
      Array<std::size_t> joined;  // shares that this set's islands went to
      for (const std::uint32_t island : equal) {
        if (is_jointed_[islands.vertices(island).front()] != 0) continue;
        ++islands_of_rods_;
        const Choice choice =
            elements_.any_of(island)
                ? choose_with_elements(settings_)
                : choose(scene_, {local.view(), islands.vertices(island), islands.edges(island)}, masses,
                         settings_);
        auto share = std::find_if(shares.begin(), shares.end(),
                                  [&](const Share& each) { return each.choice == choice; });
        if (share == shares.end()) share = shares.insert(shares.end(), {choice, {}});
        const auto number = static_cast<std::size_t>(share - shares.begin());
        if (std::find(joined.begin(), joined.end(), number) == joined.end()) {
          joined.push_back(number);
          share->sets.emplace_back();
        }
        share->sets.back().push_back(island);
      }
    }
    return shares;
  }

  void add(MadeSolver made) {
    slots_.push_back(std::move(made.places));
    const auto number = static_cast<std::uint32_t>(out_.solvers.size());
    for (const auto& [cord, slot] : made.cords) cords_.push_back({cord, {number, slot}});
    for (const auto& [twist, slot] : made.twists) twists_.push_back({twist, {number, slot}});
    out_.solvers.push_back(std::move(made.solver));
  }

  void place_particles() {
    Array<Places::Entry> entries;
    std::size_t count = 0;
    for (const auto& of_solver : slots_) count += of_solver.size();
    entries.reserve(count);
    for (std::uint32_t s = 0; s < slots_.size(); ++s)
      for (const auto& [particle, slot] : slots_[s]) entries.push_back({particle, {s, slot}});
    out_.places = Places(static_cast<std::uint32_t>(scene_.particles.size()), entries);
    const auto rods = static_cast<std::uint32_t>(scene_.rods.size());
    const auto tackles = static_cast<std::uint32_t>(scene_.tackles.size());
    const auto reels = static_cast<std::uint32_t>(scene_.reels.size());
    Array<Places::Entry> of_rods, of_lines;
    of_rods.reserve(cords_.size());
    for (const auto& [cord, place] : cords_)
      if (cord < rods)
        of_rods.push_back({cord, place});
      else  // reels come first there
        of_lines.push_back({cord - rods < tackles ? reels + cord - rods : cord - rods - tackles, place});
    out_.cords = {Places(rods, of_rods), Places(tackles + reels, of_lines)};
    out_.twists = Places(static_cast<std::uint32_t>(scene_.twists.size()), twists_);
  }

  void fill_info() {
    WorldInfo& info = out_.info;
    info.particles = static_cast<std::uint32_t>(scene_.particles.size());
    info.rods = static_cast<std::uint32_t>(scene_.rods.size());
    info.islands += islands_of_rods_;
    info.isa = settings_.isa.value_or(best_isa());
    info.threads = settings_.threads;
    info.skipped_drag = scene_.drag == 0;
    info.projected_velocity = start_.projected_velocity;
    info.projected_position = start_.projected_position;
    info.unprojected_islands = start_.unprojected_islands;
    for (const auto& solver : out_.solvers) solver->describe(info);
    out_.kinds = start_.kinds;
  }

  const Scene& scene_;
  const Settings& settings_;
  const SceneGraph scene_graph_;
  const layouts::Graph graph_;
  static constexpr std::uint32_t none = 0xffffffff;

  Array<std::uint8_t> is_jointed_;  ///< by particle: its island has more than particles and rods
  const layouts::Islands islands_;
  const IslandElements elements_;
  Array<Named> element_at_;  ///< by particle: its first element, once it was asked for
  std::uint32_t islands_of_rods_ = 0;
  std::unique_ptr<ContactSolver> contact_;
  Compiled out_;
  StartReport start_{.kinds = std::make_shared<TreeKinds>()};
  Array<Array<MadeSolver::Place>> slots_;  ///< by solver
  Array<Places::Entry> cords_, twists_;
};

}  // namespace

Compiled compile(const std::shared_ptr<const Scene>& scene, const Settings& settings) {
  return Compiler(*scene, settings).make(scene);
}

Compiled compile_parts(const Scene& parts, const Settings& settings, const Compiled& whole) {
  return Compiler(parts, settings).make_parts(whole);
}

Compiled compile_addition(const Scene& addition, const Settings& settings, const Compiled& whole) {
  return Compiler(addition, settings).make_addition(whole);
}

}  // namespace plumb::detail
