#include "interface/problems.hpp"

#include <iterator>

namespace plumb::detail {
namespace {

struct Trouble {
  Problem::Kind kind;
  std::uint64_t (*count)(const StepReport&);
};
constexpr Trouble all_troubles[] = {
    {Problem::Kind::frozen, [](const StepReport& r) { return std::uint64_t{r.frozen_islands}; }},
    {Problem::Kind::unsolved, [](const StepReport& r) { return r.unsolved; }},
    {Problem::Kind::inaccurate, [](const StepReport& r) { return r.inaccurate_steps; }},
    {Problem::Kind::capped, [](const StepReport& r) { return r.capped_steps; }},
};

}  // namespace

Troubles troubles_between(const StepReport& before, const StepReport& after) {
  Troubles out = 0;
  for (unsigned i = 0; i < std::size(all_troubles); ++i)
    if (all_troubles[i].count(after) != all_troubles[i].count(before))
      out = static_cast<Troubles>(out | 1u << i);
  return out;
}

RodJudge::RodJudge(const Scene& scene) {
  grow(scene.rods.size());
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    add(i, rod, scene.particles[rod.a].fixed ? rod.b : rod.a);
  }
}

void append_problems(Troubles troubles, std::uint32_t particle, std::vector<Problem>& out) {
  for (unsigned i = 0; i < std::size(all_troubles); ++i)
    if ((troubles & 1u << i) != 0) out.push_back({all_troubles[i].kind, particle});
}

}  // namespace plumb::detail

namespace plumb {

std::string_view to_string(Problem::Kind kind) {
  switch (kind) {
    case Problem::Kind::frozen:
      return "frozen";
    case Problem::Kind::unsolved:
      return "unsolved";
    case Problem::Kind::inaccurate:
      return "inaccurate";
    case Problem::Kind::capped:
      return "capped";
    case Problem::Kind::stretched:
      break;
  }
  return "stretched";
}

}  // namespace plumb
