#include "interface/problems.hpp"

namespace plumb::detail {

std::uint64_t count_of(Problem::Kind kind, const StepReport& report) {
  switch (kind) {
    case Problem::Kind::frozen:
      return report.frozen_islands;
    case Problem::Kind::unsolved:
      return report.unsolved;
    case Problem::Kind::elastic:
      return report.elastic_substeps;
    case Problem::Kind::inaccurate:
      return report.inaccurate_steps;
    case Problem::Kind::capped:
      return report.capped_steps;
    case Problem::Kind::stretched:
      break;
  }
  return 0;
}

Troubles troubles_between(const StepReport& before, const StepReport& after) {
  Troubles out = 0;
  for (unsigned i = 0; i < trouble_kinds.size(); ++i)
    if (count_of(trouble_kinds[i], after) != count_of(trouble_kinds[i], before))
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

void append_problems(Troubles troubles, std::uint32_t particle, Array<Problem>& out) {
  for_troubles(troubles, [&](Problem::Kind kind) { out.push_back({kind, particle}); });
}

}  // namespace plumb::detail

namespace plumb {

std::string_view to_string(Problem::Kind kind) {
  switch (kind) {
    case Problem::Kind::frozen:
      return "frozen";
    case Problem::Kind::unsolved:
      return "unsolved";
    case Problem::Kind::elastic:
      return "elastic";
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
