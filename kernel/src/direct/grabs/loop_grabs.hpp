#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "interface/grab.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

struct LoopState;
struct LoopWorkspace;

/// Holds a grab of an island with loops: of a node, or of a place on a rod whose mass couples its ends.
struct LoopGrab : HeldGrab {
  struct Part {
    std::uint32_t vertex = 0;
    double share = 0;
  };
  std::uint32_t count = 0;
  std::array<Part, 2> parts{};
  std::uint32_t rod = 0;  ///< on which the place is, if it has two parts
  GrabSubstep substep{};  ///< the one under way

  std::span<const Part> all() const { return {parts.data(), count}; }
};

/// Lists numbers of a state that grabs have changed for a substep, and what they are else.
struct ChangedNumbers {
  Array<std::pair<double*, double>> all;

  void change(double& number, double by) {
    all.emplace_back(&number, number);
    number += by;
  }
  void put_back() {
    while (!all.empty()) {
      *all.back().first = all.back().second;
      all.pop_back();
    }
  }
};

/// How a substep of `h` (s) begins: u goes into it `ratio` times, and force by `kick` (s²).
struct GrabBegin {
  double h, ratio, kick;
};
void begin_grabs(LoopState& state, const GrabBegin& substep, Gradient gradient, LoopWorkspace& work);
/// Ends it, where velocities of gradient mid have been found. They decay by `decay` in its second half.
void end_grabs(LoopState& state, const GrabBegin& substep, double decay, LoopWorkspace& work);
/// Lets velocities at the end of the last substep be found with what grabs do there, of gradient old.
void hold_at_end(LoopState& state, LoopWorkspace& work);
/// Tells lines of masses that have changed.
void note_masses(const LoopState& state, LoopWorkspace& work);

template <class Archive>
void visit_members(Archive& archive, LoopGrab::Part& of) {
  auto& [vertex, share] = of;
  archive(vertex, share);
}
template <class Archive>
void visit_members(Archive& archive, LoopGrab& of) {
  archive(static_cast<HeldGrab&>(of), of.count, of.parts, of.rod);
}

}  // namespace plumb::detail
