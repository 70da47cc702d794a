#include "direct/newton_cost.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "direct/trees/line_segments.hpp"
#include "direct/trees/tree_stepper.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/trees.hpp"
#include "scene/scene_graph.hpp"
#include "scenes/generators/generators.hpp"
#include "support/check.hpp"
#include "threads/flush_denormals.hpp"

namespace plumb::bench {
namespace {

using namespace detail;

constexpr double substep = 1.0 / 480;  // length of a substep, s
constexpr double sample_s = 1e-3;
constexpr int law_steps = 96;             // a fifth of a second, before chains whip
constexpr std::uint32_t law_chains = 16;  // they stay in the caches

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Makes trees of the equal chains of a scene, `lanes` at a time, as DirectSimulation holds them.
template <class T>
struct Trees {
  Trees(const Scene& scene, std::uint32_t width) {
    const SceneGraph owner(scene);
    const layouts::Graph graph = owner.view();
    const layouts::Islands islands = layouts::find_islands(graph);
    const auto equal = layouts::group_equal_islands(graph, islands).front();
    const layouts::LocalGraph local = layouts::local_graph(graph, islands, equal.front());
    const auto tree = layouts::find_tree(local.view());
    topology = std::make_shared<const TreeTopology>(*tree);
    for (std::size_t first = 0; first < equal.size(); first += width) {
      TreeState<T>& state = states.emplace_back(topology, width);
      for (std::uint32_t lane = 0; lane < width; ++lane) {
        const std::uint32_t island = equal[first + lane];
        state.fill_lane(lane, scene, MassModel::consistent, *tree,
                        {islands.vertices(island), islands.edges(island)});
      }
    }
  }
  std::shared_ptr<const TreeTopology> topology;
  std::vector<TreeState<T>> states;
};

/// Makes substeps, and calls its Newton kernel alone.
class Contestant {
 public:
  virtual ~Contestant() = default;
  virtual void step(detail::Tally& counters) = 0;
  virtual void call_kernel() = 0;
  /// Saves what repeated calls change for good, which is the multipliers, by rounding.
  virtual void save() = 0;
  virtual void restore() = 0;
  /// Keeps the motion of now, to go back to it.
  virtual void keep() = 0;
  virtual void rewind() = 0;
  virtual double rods_per_kernel() const = 0;
  virtual double rods_per_newton() const = 0;
  virtual double rods() const = 0;
  virtual std::vector<double> positions() const = 0;
  NewtonCost cost;
};

template <class T>
struct Multipliers {
  std::vector<T> mu, tie_mu;
  void take(const TreeState<T>& state) {
    mu.assign(state.mu.data(), state.mu.data() + state.mu.size());
    tie_mu.assign(state.tie_mu.data(), state.tie_mu.data() + state.tie_mu.size());
  }
  void give_back(TreeState<T>& state) const {
    std::copy(mu.begin(), mu.end(), state.mu.data());
    std::copy(tie_mu.begin(), tie_mu.end(), state.tie_mu.data());
  }
};

template <class T>
class InLanes final : public Contestant {
 public:
  void save() override { saved_.take(trees_.states.back()); }
  void restore() override { saved_.give_back(trees_.states.back()); }
  void keep() override {
    for (const TreeState<T>& state : trees_.states)
      kept_.emplace_back(trees_.topology, state.lanes).copy_motion(state);
  }
  void rewind() override {
    for (std::size_t i = 0; i < kept_.size(); ++i) trees_.states[i].copy_motion(kept_[i]);
  }

  InLanes(const Scene& scene, Gradient gradient, Isa isa, std::uint32_t lanes)
      : gradient_(gradient),
        kernels_(simd::tree_kernels<T>(isa)),
        stepper_(gradient, 0, false, isa),
        trees_(scene, lanes),
        work_(*trees_.topology, lanes),
        alone_(trees_.topology),
        alone_work_(*trees_.topology, 1) {}

  void step(detail::Tally& counters) override {
    for (TreeState<T>& state : trees_.states)
      stepper_.advance(state, substep, {work_, alone_, alone_work_}, counters);
  }
  void call_kernel() override {
    TreeState<T>& state = trees_.states.back();  // the state that the workspace was last used for
    if (TreeStepper<T>::is_line(state, gradient_)) {
      kernels_.newton_line(work_.view(state));
    } else {
      kernels_.newton(work_.view(state), gradient_ == Gradient::mid ? T(0.5) : T(0));
    }
  }
  double rods_per_kernel() const override { return rods_per_newton() * trees_.states.front().lanes; }
  double rods_per_newton() const override { return trees_.topology->nodes; }
  double rods() const override { return rods_per_kernel() * static_cast<double>(trees_.states.size()); }
  std::vector<double> positions() const override {
    std::vector<double> out;
    for (const TreeState<T>& state : trees_.states)
      for (std::uint32_t lane = 0; lane < state.lanes; ++lane)
        for (std::uint32_t i = 0; i < 3 * trees_.topology->nodes; ++i)
          out.push_back(state.x[state.at(i, lane)]);
    return out;
  }

 private:
  Gradient gradient_;
  const simd::TreeKernels<T>& kernels_;
  TreeStepper<T> stepper_;
  Trees<T> trees_;
  TreeWorkspace<T> work_;
  detail::LoneTree<T> alone_;
  TreeWorkspace<T> alone_work_;
  Multipliers<T> saved_;
  std::vector<TreeState<T>> kept_;
};

template <class T>
class InSegments final : public Contestant {
 public:
  void save() override { saved_.take(state_); }
  void restore() override { saved_.give_back(state_); }
  void keep() override { kept_.emplace_back(state_.topology, state_.lanes).copy_motion(state_); }
  void rewind() override { state_.copy_motion(kept_.front()); }

  InSegments(const Scene& scene, Isa isa)
      : kernels_(simd::tree_kernels<T>(isa)),
        stepper_(Gradient::old, 0, false, isa),
        trees_(scene, 1),
        segments_(trees_.topology->nodes, layouts::lane_width<T>),
        state_(segments_.cut(trees_.states.front())),
        work_(*state_.topology, state_.lanes),
        alone_(trees_.states.front()),
        alone_work_(*trees_.topology, 1) {}

  void step(detail::Tally& counters) override {
    stepper_.advance(segments_, state_, substep, {work_, alone_, alone_work_}, counters);
  }
  void call_kernel() override { kernels_.newton_segments(work_.view(state_)); }
  double rods_per_kernel() const override { return rods(); }
  double rods_per_newton() const override { return rods(); }
  double rods() const override { return trees_.topology->nodes; }
  std::vector<double> positions() const override {
    std::vector<double> out;
    for (std::uint32_t i = 0; i < trees_.topology->nodes; ++i)
      for (std::uint32_t c = 0; c < 3; ++c)
        out.push_back(state_.x[state_.at(3 * segments_.entry(i) + c, segments_.lane(i))]);
    return out;
  }

 private:
  const simd::TreeKernels<T>& kernels_;
  TreeStepper<T> stepper_;
  Trees<T> trees_;
  LineSegments segments_;
  TreeState<T> state_;
  TreeWorkspace<T> work_;
  detail::LoneTree<T> alone_;
  TreeWorkspace<T> alone_work_;
  Multipliers<T> saved_;
  std::vector<TreeState<T>> kept_;
};

template <class C, class... Args>
void enter(std::vector<std::unique_ptr<Contestant>>& all, const NewtonCost& cost, Args&&... args) {
  all.push_back(std::make_unique<C>(std::forward<Args>(args)...));
  all.back()->cost = cost;
}

/// Times all contestants by turns, as many substeps each. With `most_steps` every round begins where the
/// first one did and takes no more than these.
void hold(std::vector<std::unique_ptr<Contestant>>& all, std::uint32_t rounds, int most_steps = 0) {
  const FlushDenormals flush;
  constexpr double never = std::numeric_limits<double>::infinity();
  detail::Tally ignored;
  std::vector<int> calls;
  double fastest = never;
  for (auto& one : all) {
    for (int i = 0; i < 4; ++i) one->step(ignored);
    fastest = std::min(fastest, seconds_of([&] { one->step(ignored); }));
    if (most_steps > 0) one->keep();
    one->save();
    calls.push_back(static_cast<int>(std::ceil(sample_s / seconds_of([&] { one->call_kernel(); }))));
    one->restore();
    one->cost.substep_ns = one->cost.newton_ns = one->cost.kernel_ns = never;
  }
  // A sample of the fastest is so long that what the others left in caches does not count.
  int steps = static_cast<int>(std::ceil(sample_s / fastest));
  if (most_steps > 0) steps = std::min(steps, most_steps);
  for (std::uint32_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      Contestant& one = *all[i];
      if (most_steps > 0) one.rewind();
      detail::Tally counters;
      const double step_s = seconds_of([&] {
        for (int k = 0; k < steps; ++k) one.step(counters);
      });
      if (counters.unsolved != 0) throw CheckFailed("a substep was not solved");
      one.cost.halvings += counters.halvings;
      const double newton_rods = static_cast<double>(counters.newton) * one.rods_per_newton();
      NewtonCost& cost = one.cost;
      const double substep_ns = 1e9 * step_s / (steps * one.rods());
      if (substep_ns < cost.substep_ns) {
        cost.substep_ns = substep_ns;
        cost.newton_ns = 1e9 * step_s / newton_rods;
        cost.newton_per_substep = newton_rods / (steps * one.rods());
      }
      one.save();
      const double kernel_s = seconds_of([&] {
        for (int k = 0; k < calls[i]; ++k) one.call_kernel();
      });
      one.restore();
      cost.kernel_ns = std::min(cost.kernel_ns, 1e9 * kernel_s / (calls[i] * one.rods_per_kernel()));
    }
  }
}

std::vector<NewtonCost> costs_of(const std::vector<std::unique_ptr<Contestant>>& all) {
  std::vector<NewtonCost> costs;
  for (const auto& one : all) costs.push_back(one->cost);
  return costs;
}

/// Checks that all but the baseline have moved to the same bits as the first of them.
void check_same(const std::vector<std::unique_ptr<Contestant>>& all, std::size_t first) {
  for (std::size_t i = first; i < all.size(); ++i)
    if (all[i]->positions() != all[first]->positions())
      throw CheckFailed("chains alone, in lanes or on other instruction sets ended in different bits");
}

template <class T>
void measure_lanes(Precision precision, Gradient gradient, std::uint32_t rounds,
                   std::vector<NewtonCost>& costs) {
  const Scene scene = scenes::make_ensemble({.chains = 256, .links = 32, .end_mass = 10});
  std::vector<std::unique_ptr<Contestant>> all;
  NewtonCost cost{.precision = precision, .gradient = gradient, .links = 32, .alone = true};
  enter<InLanes<T>>(all, cost, scene, gradient, Isa::scalar, 1u);
  cost.alone = false;
  for (const Isa isa : all_isas()) {
    if (!is_supported(isa)) continue;
    cost.isa = isa;
    enter<InLanes<T>>(all, cost, scene, gradient, isa, layouts::lane_width<T>);
  }
  hold(all, rounds);
  check_same(all, 0);
  const auto more = costs_of(all);
  costs.insert(costs.end(), more.begin(), more.end());
}

template <class T>
void measure_long_chain(Precision precision, std::uint32_t links, std::uint32_t rounds,
                        std::vector<NewtonCost>& costs) {
  const Scene scene = scenes::make_chain({.links = links, .end_mass = 10});
  std::vector<std::unique_ptr<Contestant>> all;
  NewtonCost cost{.precision = precision, .gradient = Gradient::old, .links = links, .alone = true};
  enter<InLanes<T>>(all, cost, scene, Gradient::old, Isa::scalar, 1u);
  cost.alone = false;
  for (const Isa isa : all_isas()) {
    if (!is_supported(isa)) continue;
    cost.isa = isa;
    enter<InSegments<T>>(all, cost, scene, isa);
  }
  hold(all, rounds);
  check_same(all, 1);
  const auto more = costs_of(all);
  costs.insert(costs.end(), more.begin(), more.end());
}

Scene with_law(Scene scene, const RodLaw& law) {
  for (Rod& rod : scene.rods) rod.law = law;
  return scene;
}

Scene law_ensemble(const RodLaw& law) {
  return with_law(scenes::make_ensemble({.chains = law_chains, .links = 32, .end_mass = 10}), law);
}

/// Checks that chains alone and in lanes move alike.
template <class T>
void check_law(Gradient gradient, const RodLaw& law) {
  std::vector<std::unique_ptr<Contestant>> all;
  enter<InLanes<T>>(all, {}, law_ensemble(law), gradient, Isa::scalar, 1u);
  enter<InLanes<T>>(all, {}, law_ensemble(law), gradient, best_isa(), layouts::lane_width<T>);
  const FlushDenormals flush;
  detail::Tally ignored;
  for (auto& one : all)
    for (int i = 0; i < 48; ++i) one->step(ignored);
  check_same(all, 0);
}

/// Times one form of chains for every law by turns.
template <class T>
LawCosts measure_form(Form form, Gradient gradient, const std::vector<RodLaw>& laws, std::uint32_t rounds) {
  std::vector<std::unique_ptr<Contestant>> all;
  for (const RodLaw& law : laws) {
    if (form == Form::segments)
      enter<InSegments<T>>(all, {}, with_law(scenes::make_chain({.links = 1000, .end_mass = 10}), law),
                           best_isa());
    if (form == Form::lanes)
      enter<InLanes<T>>(all, {}, law_ensemble(law), gradient, best_isa(), layouts::lane_width<T>);
    if (form == Form::alone) enter<InLanes<T>>(all, {}, law_ensemble(law), gradient, Isa::scalar, 1u);
  }
  hold(all, rounds, law_steps);
  return {form, costs_of(all)};
}

template <class T>
std::vector<LawCosts> measure_laws_in(Gradient gradient, const std::vector<RodLaw>& laws,
                                      std::uint32_t rounds) {
  for (const RodLaw& law : laws) check_law<T>(gradient, law);
  std::vector<LawCosts> out;
  for (const Form form : {Form::alone, Form::lanes, Form::segments}) {
    if (form == Form::segments && gradient != Gradient::old) continue;
    out.push_back(measure_form<T>(form, gradient, laws, rounds));
  }
  return out;
}

}  // namespace

std::vector<NewtonCost> measure_lanes(std::uint32_t rounds) {
  std::vector<NewtonCost> costs;
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    measure_lanes<float>(Precision::single, gradient, rounds, costs);
    measure_lanes<double>(Precision::double_, gradient, rounds, costs);
  }
  return costs;
}

std::vector<NewtonCost> measure_long_chain(std::uint32_t links, std::uint32_t rounds) {
  std::vector<NewtonCost> costs;
  measure_long_chain<float>(Precision::single, links, rounds, costs);
  measure_long_chain<double>(Precision::double_, links, rounds, costs);
  return costs;
}

std::vector<LawCosts> measure_laws(Precision precision, Gradient gradient, const std::vector<RodLaw>& laws,
                                   std::uint32_t rounds) {
  return precision == Precision::single ? measure_laws_in<float>(gradient, laws, rounds)
                                        : measure_laws_in<double>(gradient, laws, rounds);
}

const NewtonCost* find_cost(const std::vector<NewtonCost>& costs, Precision precision, Gradient gradient,
                            bool alone, Isa isa) {
  for (const NewtonCost& cost : costs)
    if (cost.precision == precision && cost.gradient == gradient && cost.alone == alone &&
        (alone || cost.isa == isa))
      return &cost;
  return nullptr;
}

}  // namespace plumb::bench
