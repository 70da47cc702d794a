#include "relax/relax.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "threads/wavefront.hpp"

namespace plumb::detail {
namespace {

using Clock = std::chrono::steady_clock;
using layouts::Coupling;

/// This is the largest |C|/L^2 at which gradient mid trusts its own velocities. Beyond it 2p - u turns the
/// unresolved part of a step into velocity along the rods, and the damped p + kick is the better estimate.
constexpr double mid_guard_violation = 0.05;

/// |C|/L^2 is |(1 + strain)^2 - 1|. The compressed side is the stricter one.
template <class T>
T largest_violation(const StopRule& stop) {
  if (!stop.tolerance) return 0;
  return static_cast<T>(*stop.tolerance * (2 - std::min(*stop.tolerance, 1.0)));
}

/// This team of one works on independent positions.
struct Alone {
  static constexpr unsigned parts() { return 1; }
  template <class F>
  void for_parts(F&& f) {
    f(0);
  }
};

/// A substep moves positions [q0, q1) of a block.
template <class T>
struct Moved {
  Block<T>& block;
  T* last;  ///< It is the displacement of the last substep, in m.
  T* own;   ///< It is the displacement of this one, in m.
  std::uint32_t q0, q1;
  bool is_first;        ///< It is the first of several substeps.
  Leftovers leftovers;  ///< as it finds them
};

/// Runs the stages of one substep.
template <class T, class Crew>
class Substep {
 public:
  Substep(const Moved<T>& moved, const RelaxSettings<T>& settings, StepReport& report, Crew& crew)
      : block_(moved.block),
        packing_(block_.packing()),
        kernels_(*settings.kernels),
        access_(settings.kernels->access[static_cast<int>(packing_.access)]),
        settings_(settings),
        report_(report),
        crew_(crew),
        u_(moved.last),
        p_(moved.own),
        view_(block_.law_view(p_, moved.is_first ? settings.first_terms : settings.terms)),
        pull_(moved.is_first ? settings.first_pull : settings.pull),
        bound_(largest_violation<T>(settings.stop)),
        keeping_(moved.leftovers, settings.h),
        q0_(moved.q0),
        q1_(moved.q1) {}

  void run() {
    predict_and_prepare();
    if (!packing_.stages.empty()) solve();
    advance();
  }

 private:
  // --- Geometry. Parts are cut at the same places for particles and rods, so that a thread keeps its cache.

  struct Cut {
    std::uint32_t begin, end;
  };
  Cut positions_of(unsigned part) const {
    return {q0_ + Team::begin_of(q1_ - q0_, part, crew_.parts()),
            q0_ + Team::begin_of(q1_ - q0_, part + 1, crew_.parts())};
  }
  /// Returns a part's share of `n` items, in steps of `grain`.
  Cut share_of(unsigned part, std::uint32_t n, std::uint32_t grain) const {
    const std::uint32_t grains = (n + grain - 1) / grain;
    return {std::min(n, Team::begin_of(grains, part, crew_.parts()) * grain),
            std::min(n, Team::begin_of(grains, part + 1, crew_.parts()) * grain)};
  }
  Cut elements_of(unsigned part) const {
    if (packing_.positions == 1) return share_of(part, packing_.position_elements, packing_.lanes);
    const Cut q = positions_of(part);
    return {q.begin * packing_.position_elements, q.end * packing_.position_elements};
  }
  /// Calls f(first element, number of elements) for the particle numbers of a part.
  template <class F>
  void for_elements(unsigned part, F&& f) const {
    const Cut cut = elements_of(part);
    if (cut.begin == cut.end) return;
    for (std::uint32_t stream = 0; stream < packing_.streams; ++stream)
      f(stream * packing_.stream_pitch + cut.begin, cut.end - cut.begin);
  }
  /// Calls f(range) for the rods of a part.
  template <class F>
  void for_rods(unsigned part, F&& f) const {
    if (packing_.positions > 1 || crew_.parts() == 1) {
      const Cut q = positions_of(part);
      for (std::uint32_t position = q.begin; position < q.end; ++position)
        for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage) f(range_of(position, stage));
      return;
    }
    for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage) f(stage_part(stage, part));
  }
  simd::Range range_of(std::uint32_t position, std::size_t stage) const {
    simd::Range range = block_.range(position, stage);
    range.uniform = range.uniform && !block_.is_keeping();
    return range;
  }
  simd::Range stage_part(std::size_t stage, unsigned part) const {
    simd::Range range = range_of(q0_, stage);
    const Cut cut = share_of(part, range.end - range.begin, 1);
    return {range.begin + cut.begin, range.begin + cut.end, range.uniform};
  }

  // --- Stages

  void predict_and_prepare() {
    settings_.grabs.begin(block_, settings_.gradient, u_, q0_, q1_);
    std::array<T, Team::max_size> kept{};
    crew_.for_parts([&](unsigned part) {
      for_elements(part, [&](std::uint32_t first, std::uint32_t n) {
        kernels_.particles.predict(p_ + first, u_ + first, block_.kick() + first, settings_.decay, n);
      });
      for_rods(part, [&](simd::Range range) {
        block_.gives() ? access_.laws.prepare(view_, range) : access_.prepare(view_, range);
        if (block_.is_keeping()) kept[part] = std::max(kept[part], block_.keep_violations(range, keeping_));
        if (pull_ != 0) block_.begin_moves(range);
      });
    });
    const T most = *std::max_element(kept.begin(), kept.begin() + crew_.parts());
    if (can_meet_ = most < bound_; can_meet_) bound_ -= most;
  }

  void solve() {
    const StopRule& stop = settings_.stop;
    if (!stop.tolerance && !stop.budget_us) {
      sweep(stop.sweeps);
      stopped(StoppedBy::sweeps, stop.sweeps);
      return;
    }
    const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                             std::chrono::duration<double, std::micro>(settings_.budget_us));
    std::uint32_t done = 0;
    while (true) {
      if (stop.tolerance && violation() <= bound_) {
        if (done == 0) ++report_.skipped_within_tolerance;
        return stopped(can_meet_ ? StoppedBy::tolerance : StoppedBy::sweeps, done);
      }
      if (done == stop.sweeps) return stopped(StoppedBy::sweeps, done);
      if (stop.budget_us && done > 0 && Clock::now() >= deadline) return stopped(StoppedBy::budget, done);
      // Looking costs almost half a sweep, so it comes less often as sweeps add up. A budget needs the clock
      // every sweep.
      const std::uint32_t next = stop.budget_us ? 1 : std::min(1 + done / 4, stop.sweeps - done);
      sweep(next);
      done += next;
    }
  }

  void advance() {
    std::atomic<bool> broken{false};
    crew_.for_parts([&](unsigned part) {
      for_elements(part, [&](std::uint32_t first, std::uint32_t n) {
        if (!kernels_.particles.all_finite(block_.x() + first, p_ + first, n))
          broken.store(true, std::memory_order_relaxed);
      });
    });
    if (block_.gives() && settings_.gradient == Gradient::old)
      crew_.for_parts([&](unsigned part) {
        for_rods(part, [&](simd::Range range) { access_.laws.finish(view_, range); });
      });
    if (broken.load(std::memory_order_relaxed))
      report_.frozen_islands += block_.freeze_broken_islands(u_, p_, q0_, q1_);

    const bool guarded = settings_.gradient == Gradient::mid && !packing_.stages.empty() &&
                         (block_.is_settling() || violation() > mid_guard_violation);
    if (guarded) {
      ++report_.mid_guarded;
      pull_ *= 0.5;  // Such a velocity has a move once, where 2p - u has it twice.
    }
    if (pull_ != 0)
      crew_.for_parts([&](unsigned part) {
        for_rods(part, [&](simd::Range range) { block_.count_moves(range, pull_); });
      });
    if (block_.is_keeping())
      crew_.for_parts([&](unsigned part) {
        for_rods(part, [&](simd::Range range) { block_.restore_lengths(range, *settings_.constants); });
      });
    settings_.grabs.see(block_, p_, q0_, q1_);
    crew_.for_parts([&](unsigned part) {
      for_elements(part, [&](std::uint32_t first, std::uint32_t n) {
        const auto& particles = kernels_.particles;
        T* x = block_.x() + first;
        T* p = p_ + first;
        if (settings_.gradient != Gradient::mid) {
          particles.advance(x, p, n);
        } else if (guarded) {
          particles.advance_mid_guarded(x, p, block_.kick() + first, settings_.decay, n);
        } else {
          particles.advance_mid(x, p, u_ + first, settings_.decay, n);
        }
      });
    });
    block_.rest_anchors(p_, q0_, q1_);
    settings_.grabs.end(block_, settings_.gradient, guarded, p_, q0_, q1_);
    if (block_.breaks()) break_rods();
  }

  void break_rods() {
    std::array<std::uint32_t, Team::max_size> broken{};
    crew_.for_parts([&](unsigned part) {
      for_rods(part,
               [&](simd::Range range) { broken[part] += block_.break_rods(range, pull_, settings_.h); });
    });
    for (unsigned part = 0; part < crew_.parts(); ++part) report_.broken_rods += broken[part];
  }

  // --- Sweeps

  void sweep(std::uint32_t n) {
    if (settings_.order == SweepOrder::jacobi) {
      for (std::uint32_t i = 0; i < n; ++i) sweep_jacobi();
    } else if (packing_.coupling == Coupling::neighbor) {
      sweep_pipelined(n);
    } else if (crew_.parts() == 1) {
      Queue queue(*this);
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage)
          for (std::uint32_t q = q0_; q < q1_; ++q) queue.add(range_of(q, stage));
    } else {
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage) run_stage(stage);
    }
  }

  /// These ranges are projected in order, and handed to the kernel many at a time.
  class Queue {
   public:
    explicit Queue(const Substep& substep) : substep_(substep) {}
    ~Queue() { flush(); }
    void add(simd::Range range) {
      if (count_ == ranges_.size()) flush();
      ranges_[count_++] = range;
    }

   private:
    void flush() {
      const auto gradient = static_cast<int>(substep_.settings_.gradient);
      if (substep_.block_.gives()) {
        substep_.access_.laws.sweep[gradient](substep_.view_, ranges_.data(), count_);
      } else {
        const auto& kernels = substep_.pull_ != 0 ? substep_.access_.count : substep_.access_.sweep;
        kernels[gradient](substep_.view_, ranges_.data(), count_);
      }
      count_ = 0;
    }

    const Substep& substep_;
    std::array<simd::Range, 64> ranges_;
    std::uint32_t count_ = 0;
  };

  /// Projects all rods of one stage at once.
  void run_stage(std::size_t stage) {
    crew_.for_parts([&](unsigned part) {
      Queue queue(*this);
      if (packing_.positions == 1 && crew_.parts() > 1) return queue.add(stage_part(stage, part));
      const Cut q = positions_of(part);
      for (std::uint32_t position = q.begin; position < q.end; ++position)
        queue.add(range_of(position, stage));
    });
  }

  void sweep_jacobi() {
    for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage) run_stage(stage);
    crew_.for_parts([&](unsigned part) {
      for_elements(part, [&](std::uint32_t first, std::uint32_t n) {
        kernels_.particles.accumulate(p_ + first, block_.accumulator() + first, n);
      });
    });
  }

  template <class Bounds>
  void run_pipeline(std::int64_t sweeps, const Bounds& bounds) {
    Queue queue(*this);
    const auto add = [&](std::int64_t q, std::size_t begin, std::size_t end) {
      for (std::size_t stage = begin; stage < end; ++stage)
        queue.add(range_of(static_cast<std::uint32_t>(q), stage));
    };
    run_wavefront(
        sweeps, bounds, [&](std::int64_t q) { add(q, 0, packing_.within_stages); },
        [&](std::int64_t q) { add(q, packing_.within_stages, packing_.stages.size()); });
  }

  void sweep_pipelined(std::uint32_t n) {
    const unsigned parts = crew_.parts();
    const std::int64_t most =
        parts == 1 ? sweeps_in_flight
                   : std::min(sweeps_in_flight, sweeps_between_barriers(packing_.positions, parts));
    if (most < 1) {  // it is too short to share, so the leader does it alone
      for (std::int64_t left = n; left > 0; left -= sweeps_in_flight)
        run_pipeline(std::min(left, sweeps_in_flight), Trapezoid{0, packing_.positions, true, true});
      return;
    }
    for (std::int64_t left = n; left > 0; left -= most) {
      const std::int64_t now = std::min(left, most);
      crew_.for_parts([&](unsigned part) {
        const Cut q = positions_of(part);
        run_pipeline(now, Trapezoid{q.begin, q.end, part == 0, part + 1 == parts});
      });
      if (parts > 1)
        crew_.for_parts([&](unsigned part) {
          if (part > 0) run_pipeline(now, CutTriangle{positions_of(part).begin});
        });
    }
  }

  T violation() {
    std::array<T, Team::max_size> largest{};
    crew_.for_parts([&](unsigned part) {
      for_rods(part, [&](simd::Range range) {
        const T found = block_.gives()
                            ? access_.laws.violation[static_cast<int>(settings_.gradient)](view_, range)
                            : access_.violation(view_, range);
        largest[part] = std::max(largest[part], found);
      });
    });
    return *std::max_element(largest.begin(), largest.begin() + crew_.parts());
  }

  void stopped(StoppedBy reason, std::uint32_t sweeps) {
    report_.block_sweeps += sweeps;
    report_.rod_projections += std::uint64_t{sweeps} * block_.rods(q0_, q1_);
    report_.stopped_by = std::max(report_.stopped_by, reason);
  }

  Block<T>& block_;
  const layouts::Packing& packing_;
  const simd::Kernels<T>& kernels_;
  const simd::AccessKernels<T>& access_;
  const RelaxSettings<T>& settings_;
  StepReport& report_;
  Crew& crew_;
  T* u_;  ///< It is the displacement of the last substep, in m.
  T* p_;  ///< It is the displacement of this one, in m.
  simd::LawView<T> view_;
  double pull_;  ///< It makes impulses of moves, in 1/s; it is 0 if pulls do not count.
  T bound_;      ///< Sweeps end at such a |C|/L² beside what is kept, if there is a tolerance.
  Keeping<T> keeping_;
  bool can_meet_ = true;  ///< What is kept is within the tolerance.
  std::uint32_t q0_, q1_;
};

}  // namespace

template <class T>
void relax_alone(Block<T>& block, std::uint32_t q0, std::uint32_t q1, const RelaxSettings<T>& settings,
                 StepReport& report) {
  Alone alone;
  Leftovers leftovers = settings.leftovers;
  for (std::uint32_t substep = 0; substep < settings.substeps; ++substep) {
    const unsigned odd = substep & 1;
    block.follow_lengths(q0, q1, settings.start + (substep + 1) * settings.h);
    const Moved<T> moved{block,    block.displacement(odd), block.displacement(1 - odd), q0, q1, substep == 0,
                         leftovers};
    Substep<T, Alone>(moved, settings, report, alone).run();
    leftovers.pass(settings.h);
  }
}

template <class T>
void relax_block(Block<T>& block, const RelaxSettings<T>& settings, std::uint32_t substep, StepReport& report,
                 Team& team) {
  block.follow_lengths(0, block.packing().positions, (substep + 1) * settings.h);
  const Moved<T> moved{
      block,        block.displacement(0), block.displacement(1), 0, block.packing().positions,
      substep == 0, settings.leftovers};
  Substep<T, Team>(moved, settings, report, team).run();
  block.count_substeps(1);
}

template void relax_alone(Block<float>&, std::uint32_t, std::uint32_t, const RelaxSettings<float>&,
                          StepReport&);
template void relax_alone(Block<double>&, std::uint32_t, std::uint32_t, const RelaxSettings<double>&,
                          StepReport&);
template void relax_block(Block<float>&, const RelaxSettings<float>&, std::uint32_t, StepReport&, Team&);
template void relax_block(Block<double>&, const RelaxSettings<double>&, std::uint32_t, StepReport&, Team&);

}  // namespace plumb::detail
