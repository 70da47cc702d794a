#include "direct/loops/loop_stepper.hpp"
#include "interface/archive.hpp"

namespace plumb::detail {
namespace {

/// From so many multiplications per number on, the factor of an earlier substep, with more iterations, is
/// faster than a new one. A net of 16 x 16 particles has 30.
constexpr double costly_factor = 30;

}  // namespace

LoopWorkspace::Factor::Factor(const LoopSystem& of, Isa isa)
    : system(&of),
      ldu(of.analysis, isa),
      values(of.values()),
      smallest(of.analysis.size()),
      right(of.analysis.size()),
      acts(of.rods) {}

bool LoopWorkspace::Factor::worth_carrying() const {
  return system->analysis.operations() > costly_factor * static_cast<double>(system->analysis.factor_size());
}

LoopWorkspace::LoopWorkspace(const LoopState& state, Gradient gradient, Isa instructions)
    : topology(state.topology), isa(instructions) {
  const std::size_t n = topology->nodes, rods = topology->rods.size();
  if (topology->system) {
    first = std::make_unique<Factor>(*topology->system, isa);
    if (gradient != Gradient::mid) projection = std::make_unique<Factor>(*topology->system, isa);
  }
  if (topology->lines) lines = std::make_unique<LineWorkspace>(*topology->lines, state.mass);
  if (topology->net) net = std::make_unique<NetWorkspace>(*topology->net);
  delta.assign(3 * std::size_t{topology->vertices}, 0);
  load.assign(3 * n, 0);
  d.assign(3 * rods, 0);
  excess.assign(rods, 0);
  mu_start.assign(state.mu.size(), 0);
  blows = mu_start;
  fixed_jump.assign(topology->vertices - n, {});
  fixed_rest = fixed_jump;
  saved = state.motion();
  trial.assign(delta.size(), 0);
  start = trial;
  for (const LoopBendNumbers& bend : state.bends) bends.push_back(bend.law);
  bend_starts.assign(bends.size(), {});
  twists.resize(state.twists.size());
  reels.resize(state.reels.size());
  resists.assign(n, 0);
  for (const LoopTackle& tackle : topology->tackles)
    tackles.segments.resize(tackles.segments.size() + tackle.segments());
  tackles.starts.assign(state.tackles.size(), 0);
  tackles.lengths = tackles.starts;
  tackles.pulleys.assign(topology->pulleys(), {});
}

void LoopWorkspace::take_locks(const LoopState& state) {
  if (!lines) return;
  lines->solver.set_masses(state.mass, [&](std::uint32_t i) { return state.locks.has(i); });
  lines->forget();
}

/// All but these is found anew in every substep. A factor is listed if the next substep may use it.
void LoopWorkspace::archive(Archive& archive, const LoopState& state) {
  archive(tackles.pulleys);
  bool has_lines = lines != nullptr;
  archive(has_lines);
  if (!has_lines) lines.reset();
  if (has_lines && !lines) lines = std::make_unique<LineWorkspace>(*topology->lines, state.mass);
  if (archive.restores()) take_locks(state);
  if (lines) archive(*lines);
  for (std::unique_ptr<Factor>* const each : {&first, &second}) {
    bool is_kept = *each && (*each)->h != 0 && (*each)->worth_carrying();
    archive(is_kept);
    if (is_kept)
      archive(*each ? **each : factor(true));
    else if (*each && archive.restores())
      (*each)->h = 0;
  }
}

LoopWorkspace::Factor& LoopWorkspace::factor(bool couples) {
  if (first && (first->system->couples || !couples)) return *first;
  if (!second) {
    coupled = std::make_unique<LoopSystem>(topology->rods, topology->nodes, true, *topology);
    second = std::make_unique<Factor>(*coupled, isa);
  }
  return *second;
}

DisplacementFactor& LoopWorkspace::displacement_factor() {
  if (!displacements) displacements = std::make_unique<DisplacementFactor>(*topology, isa);
  return *displacements;
}

}  // namespace plumb::detail
