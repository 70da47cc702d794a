#include "step/state/step_log.hpp"

#include <initializer_list>
#include <string_view>
#include <vector>

#include "plumb/version.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

std::string joined(std::initializer_list<MessagePart> parts) {
  std::string out;
  for (const MessagePart& part : parts) out += part.text();
  return out;
}

/// Says in words what went wrong, and what it is to have ended. What froze stays so.
struct Words {
  std::string_view begins, ends;
};
Words words_of(Problem::Kind kind) {
  switch (kind) {
    case Problem::Kind::frozen:
      return {"islands froze: their numbers were not finite", {}};
    case Problem::Kind::unsolved:
      return {"substeps were not solved", "all is solved"};
    case Problem::Kind::elastic:
      return {"substeps had no place for rods at their lengths, which give", "rods keep their lengths"};
    case Problem::Kind::inaccurate:
      return {"steps were less accurate than asked", "steps are as accurate as asked"};
    case Problem::Kind::capped:
      return {"islands spent the work or time they had", "work and time suffice"};
    case Problem::Kind::stretched:
      break;
  }
  return {};
}

/// Names the islands that have a trouble by a particle of each; the first three are enough.
std::string islands_with(Problem::Kind kind, const std::vector<Problem>& problems) {
  constexpr unsigned most = 3;
  std::string out;
  unsigned count = 0;
  for (const Problem& problem : problems)
    if (problem.kind == kind && count++ < most)
      out += joined({count == 1 ? " (particle " : ", ", problem.particle});
  return count == 0 ? out : out + (count > most ? ", ...)" : ")");
}

}  // namespace

void StepLog::begin(const WorldInfo& info) {
  line(LogLevel::info,
       joined({"plumb ", version(), " (", to_string(info.isa),
               ", threads: ", info.parallel ? info.threads : 1u, "), particles: ", info.particles,
               ", rods: ", info.rods, " (relaxed: ", info.relaxed_rods, ", solved: ", info.direct_rods,
               "), islands: ", info.islands, ", bytes: ", std::uint64_t{info.memory}}));
  if (info.unprojected_islands > 0)
    line(LogLevel::warning,
         joined({info.unprojected_islands, " islands have rods that do not fit, which give"}));
}

void StepLog::tell(const StepReport& report, const World& world) {
  const Troubles now = troubles_between({}, report);
  const std::string time = joined({world.time(), " s: "});
  if (report.broken_rods > 0) line(LogLevel::info, joined({time, report.broken_rods, " rods broke"}));
  if (now == last_) return;
  const std::vector<Problem> problems = world.problems();
  for (unsigned i = 0; i < trouble_kinds.size(); ++i) {
    const bool is = (now & 1u << i) != 0, was = (last_ & 1u << i) != 0;
    const Problem::Kind kind = trouble_kinds[i];
    if (is && !was)
      line(LogLevel::warning,
           joined({time, count_of(kind, report), ' ', words_of(kind).begins, islands_with(kind, problems)}));
    if (was && !is && !words_of(kind).ends.empty())
      line(LogLevel::info, joined({time, words_of(kind).ends, " again"}));
  }
  last_ = now;
}

}  // namespace plumb::detail
