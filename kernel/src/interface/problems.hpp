#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "plumb/layouts/memory.hpp"
#include "plumb/report.hpp"
#include "plumb/scene.hpp"
#include "plumb/world.hpp"

namespace plumb::detail {

/// Names, as bits, what went wrong with a piece in a step, by the counts of that step.
using Troubles = std::uint8_t;
/// Returns how often that happened by a report; 0 for rods that are stretched.
std::uint64_t count_of(Problem::Kind kind, const StepReport& report);
Troubles troubles_between(const StepReport& before, const StepReport& after);
/// Says what the bits stand for.
inline constexpr std::array trouble_kinds{Problem::Kind::frozen, Problem::Kind::unsolved,
                                          Problem::Kind::elastic, Problem::Kind::inaccurate,
                                          Problem::Kind::capped};
/// Returns the bits of some kinds.
constexpr Troubles bits_of(std::initializer_list<Problem::Kind> kinds) {
  Troubles out = 0;
  for (unsigned i = 0; i < trouble_kinds.size(); ++i)
    for (const Problem::Kind kind : kinds)
      if (trouble_kinds[i] == kind) out = static_cast<Troubles>(out | 1u << i);
  return out;
}
/// Names those that go on while a piece sleeps: it stands as they left it.
inline constexpr Troubles lasting = bits_of({Problem::Kind::frozen, Problem::Kind::elastic});
/// Calls f(kind) for all that went wrong.
template <class F>
void for_troubles(Troubles troubles, F&& f) {
  for (unsigned i = 0; i < trouble_kinds.size(); ++i)
    if ((troubles & 1u << i) != 0) f(trouble_kinds[i]);
}

/// Knows what a rod needs to be judged by its length.
class RodJudge {
 public:
  explicit RodJudge(const Scene& scene);

  /// Returns a movable end of a rod.
  std::uint32_t end(std::uint32_t rod) const { return rods_[rod].first_movable; }

  void set_end(std::uint32_t rod, std::uint32_t movable) { rods_[rod].first_movable = movable; }

  /// Takes at least so many rods. New ones are as removed ones.
  void grow(std::size_t rods) {
    if (rods > rods_.size()) rods_.resize(rods, {.is_spared = true});
  }
  /// Gives a number to a rod. `movable` is one of its ends.
  void add(std::uint32_t number, const Rod& rod, std::uint32_t movable) {
    rods_[number] = {rod.a, rod.b, movable, rod.law.is_elastic(), rod.law.one_sided};
  }
  void remove(std::uint32_t rod) { rods_[rod].is_spared = true; }

  /// Appends a problem for every rod that is not elastic nor broken and whose strain is above `most_strain`.
  /// position(particle), strain(rod, distance of its ends) and is_broken(rod) say how they are.
  template <class Position, class Strain, class IsBroken>
  void judge(double most_strain, Position&& position, Strain&& strain_at, IsBroken&& is_broken,
             Array<Problem>& out) const {
    for (std::uint32_t i = 0; i < rods_.size(); ++i) {
      const auto& [a, b, first_movable, is_spared, one_sided] = rods_[i];
      if (is_spared) continue;
      const double strain = strain_at(i, norm(position(b) - position(a)));
      if ((one_sided ? strain : std::abs(strain)) <= most_strain || is_broken(i)) continue;
      out.push_back({Problem::Kind::stretched, first_movable, i, strain});
    }
  }

 private:
  struct JudgedRod {
    std::uint32_t a = 0, b = 0, first_movable = 0;
    bool is_spared = false;  ///< It is elastic, or was removed.
    bool one_sided = false;
  };
  Array<JudgedRod> rods_;
};

/// Appends the problems that troubles name, of an island with this particle.
void append_problems(Troubles troubles, std::uint32_t particle, Array<Problem>& out);

}  // namespace plumb::detail
