#include "direct/nets/loop_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "direct/loops/loop_stepper.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {
namespace {

constexpr int most_iterations = 40;
/// Where iterations converge more slowly than this, a shorter substep comes sooner to the end. The first ones
/// need not be fast, since they sort out multipliers that were extrapolated.
constexpr double lost_rate = 0.6;
constexpr int settling_iterations = 3;
/// Changes of many rod lengths do not lead back.
constexpr double hopeless = 30;
/// Below this |C|/L² gradient old's iterations all leave about the same share of what they find.
constexpr double settled = 3e-4;
/// From this share on it pays to accelerate.
constexpr double slow_rate = 0.1;
/// One solution leaves at least this share of what is left, since the next one's directions are better.
constexpr double coarse = 0.02;
/// The norm over all rods that is aimed at is this share of what may be left of the worst.
constexpr double below_tolerance = 0.1;
/// Conjugate gradients take so many iterations at most. Nets need 1 to 10.
constexpr int most_gradients = 200;
/// Rounding leaves this share of velocities along rods.
constexpr double projected = 1e-9;

/// Measures rods as they are at the start.
void measure(const LoopState& state, LineWorkspace& lines) {
  for (std::uint32_t s = 0; s < lines.lines->slots(); ++s) {
    if (lines.lines->numbers[s] == RodLines::none) continue;
    const auto [a, b] = lines.lines->ends[s];
    const Vec3 d = at(state.x, a) - at(state.x, b);
    put(&lines.d[3 * s], d);
    // What rounding leaves of a rod between locked nodes is nothing that could be mended.
    lines.excess[s] =
        lines.solver.is_held(s) ? 0 : 0.5 * (dot(d, d) - state.length2[lines.lines->numbers[s]]);
  }
}

/// Sets where multipliers start. Those of gradient old run smoothly through substeps of one length, and those
/// of the others swing from one to the next.
void start(const LoopState& state, double theta, double kick, LineWorkspace& lines) {
  if (kick != lines.past.kick || theta > 0) lines.forget();
  for (std::size_t s = 0; s < lines.mu.size(); ++s) {
    const std::uint32_t k = lines.lines->numbers[s];
    if (k == RodLines::none) continue;
    const double last = state.mu[k], before = lines.past.before[s], earlier = lines.past.earlier[s];
    lines.mu[s] = lines.past.known == 0   ? last
                  : lines.past.known == 1 ? 2 * last - before
                                          : 3 * (last - before) + earlier;
  }
}

/// Keeps what was found.
void keep(LoopState& state, double kick, LineWorkspace& lines) {
  lines.past.kick = kick;
  lines.past.known = state.mu_kick == 0 ? 0 : std::min(lines.past.known + 1, 2);
  lines.past.earlier.swap(lines.past.before);
  for (std::size_t s = 0; s < lines.mu.size(); ++s) {
    const std::uint32_t k = lines.lines->numbers[s];
    if (k == RodLines::none) continue;
    lines.past.before[s] = std::exchange(state.mu[k], lines.mu[s]);
  }
}

/// Makes displacements from loads and multipliers. Returns by how much they change, in m.
double displace(const LoopState& state, double theta, LoopWorkspace& work) {
  LineWorkspace& lines = *work.lines;
  const std::span<double> directions = lines.solver.directions();
  for (std::size_t s = 0; s < lines.mu.size(); ++s) {
    const auto [a, b] = lines.lines->ends[s];
    put(&directions[3 * s], at(lines.d, s) + theta * (at(work.delta, a) - at(work.delta, b)));
  }
  lines.solver.spread(lines.mu, lines.pushed);
  double most = 0;
  for (std::uint32_t i = 0; i < state.topology->nodes; ++i) {
    if (state.locks.has(i)) continue;
    for (std::size_t k = 3 * std::size_t{i}; k < 3 * std::size_t{i} + 3; ++k) {
      const double goes = lines.solver.inverse_mass(i) * work.load[k] + lines.pushed[k];
      most = std::max(most, std::abs(goes - work.delta[k]));
      work.delta[k] = goes;
    }
  }
  return most;
}

struct Misfit {
  double largest, norm;  ///< They are in m²; norm is not finite if any is not.
};

/// Puts -C of every rod at work.delta into `wanted`.
Misfit find_misfits(LoopWorkspace& work) {
  constexpr std::size_t lanes = RodLines::lanes;
  LineWorkspace& lines = *work.lines;
  std::array<double, lanes> most{}, sum{};
  for (std::size_t s = 0; s < lines.wanted.size(); s += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto [a, b] = lines.lines->ends[s + lane];
      const Vec3 d = at(lines.d, s + lane), e = at(work.delta, a) - at(work.delta, b);
      const double c = constraint(d, e, lines.excess[s + lane]);
      lines.wanted[s + lane] = -c;
      most[lane] = std::max(most[lane], std::abs(c));
      sum[lane] += c * c;
    }
  Misfit out{0, 0};
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    out.largest = std::max(out.largest, most[lane]);
    out.norm += sum[lane];
  }
  out.norm = std::sqrt(out.norm);
  return out;
}

/// Goes on along what two iterations with the same directions have in common. They leave mostly one mode,
/// where rods turn most, that falls by the same share every time. Anderson's acceleration (1965), one
/// iteration deep, takes it out. `again` says that there was one before.
void accelerate(bool again, LoopWorkspace& work) {
  constexpr std::size_t lanes = RodLines::lanes;
  LineWorkspace& lines = *work.lines;
  std::array<double, lanes> along{}, square{};
  for (std::size_t s = 0; s < lines.mu.size(); s += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double change = lines.mu[s + lane] - lines.start[s + lane];
      const double by = change - lines.last_change[s + lane];
      along[lane] += by * change;
      square[lane] += by * by;
      lines.last_change[s + lane] = change;
    }
  const double all = std::accumulate(square.begin(), square.end(), 0.0);
  const double back = again && all > 0 ? std::accumulate(along.begin(), along.end(), 0.0) / all : 0;
  const auto go_on = [again, back](std::span<double> values, Array<double>& last) {
    for (std::size_t k = 0; k < last.size(); ++k) {
      const double came_to = values[k];
      if (again) values[k] = came_to - back * (came_to - last[k]);
      last[k] = came_to;
    }
  };
  go_on(lines.mu, lines.last_mu);
  go_on(work.delta, lines.last_delta);  // displacements depend on multipliers linearly
}

}  // namespace

LineWorkspace::LineWorkspace(const RodLines& of, std::span<const double> mass)
    : lines(&of),
      solver(of, mass),
      d(3 * std::size_t{of.slots()}),
      excess(of.slots()),
      mu(of.slots()),
      wanted(of.slots()),
      pushed(3 * std::size_t{of.nodes}),
      start(of.slots()),
      last_change(of.slots()),
      last_mu(of.slots()),
      last_delta(3 * std::size_t{of.nodes}) {
  past.before.resize(of.slots());
  past.earlier.resize(of.slots());
}

LineOutcome iterate_by_lines(LoopState& state, double theta, double kick, double tolerance,
                             LoopWorkspace& work, Tally& counters) {
  LineWorkspace& lines = *work.lines;
  measure(state, lines);
  start(state, theta, kick, lines);
  const double length = std::sqrt(state.scale2), least = tolerance * state.scale2;
  double last = 0;
  bool crawled = false;
  for (int i = 0; i < most_iterations; ++i) {
    double worst = 0;
    if (i == 0 || theta > 0) {
      const double change = displace(state, theta, work);
      if (theta > 0) worst = length * change;
      lines.solver.factorize();
    }
    const Misfit misfit = find_misfits(work);
    if (!std::isfinite(misfit.norm)) break;
    worst = std::max(worst, misfit.largest);
    if (worst <= least) {
      keep(state, kick, lines);
      return LineOutcome::solved;
    }
    if (worst > hopeless * state.scale2 || (i >= settling_iterations && worst > lost_rate * last)) break;
    // The first iteration has no last (0). It counts, so that a second can be accelerated.
    const bool crawls = theta == 0 && worst <= settled * state.scale2 && worst > slow_rate * last;
    if (crawls) lines.start = lines.mu;
    last = worst;
    ++counters.newton;
    const double goal = std::max(coarse * misfit.norm, below_tolerance * least);
    if (!lines.solver.solve(lines.wanted, goal, most_gradients, lines.mu, work.delta)) {
      lines.forget();
      return LineOutcome::stalled;
    }
    if (crawls) accelerate(crawled, work);
    crawled = crawls;
  }
  lines.forget();
  return LineOutcome::diverged;
}

namespace {

/// Returns half the rate of a rod's squared length, m²/s.
double half_rate(const LoopState& state, std::uint32_t rod) {
  if (rod == RodLines::none || state.laws.rate.empty()) return 0;
  return std::sqrt(state.length2[rod]) * state.laws.rate[rod];
}

}  // namespace

bool project_by_lines(const LoopState& state, double kick, LoopWorkspace& work) {
  LineWorkspace& lines = *work.lines;
  const RodLines& shape = *lines.lines;
  LineSolver& solver = lines.solver;
  measure(state, lines);
  std::copy(lines.d.begin(), lines.d.end(), solver.directions().begin());
  solver.factorize();
  std::fill(lines.mu.begin(), lines.mu.end(), 0.0);
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    for (std::size_t k = 3 * std::size_t{i}; k < 3 * std::size_t{i} + 3; ++k)
      work.delta[k] += kick * solver.inverse_mass(i) * state.force[k];
  // The second time takes out what rounding left in the first.
  bool solved = true;
  for (int turn = 0; turn < 2 && solved; ++turn) {
    double square = 0;
    for (std::size_t s = 0; s < shape.slots(); ++s) {
      const auto [a, b] = shape.ends[s];
      lines.wanted[s] =
          dot(at(lines.d, s), at(work.delta, b) - at(work.delta, a)) + half_rate(state, shape.numbers[s]);
      square += lines.wanted[s] * lines.wanted[s];
    }
    const double goal = projected * std::sqrt(square);
    solved = solver.solve(lines.wanted, goal, most_gradients, lines.mu, work.delta) || turn > 0;
  }
  for (std::size_t s = 0; s < shape.slots(); ++s)
    if (shape.numbers[s] != RodLines::none) work.blows[shape.numbers[s]] = lines.mu[s];
  return solved;
}

}  // namespace plumb::detail
