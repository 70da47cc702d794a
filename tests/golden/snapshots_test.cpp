// Snapshots of every scene of the golden table. A world that goes back to one, and another world that is
// compiled anew on another machine, must come to the same bytes again: not only to the same hash, but to the
// same snapshot, which holds all that could make a later difference.

#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <vector>

#include "golden/run.hpp"
#include "golden/table.hpp"
#include "support/executors.hpp"
#include "threads/sharing.hpp"

namespace plumb::golden::PLUMB_TEST_FILE {
namespace {

using Bytes = std::vector<std::byte>;

Bytes save(const World& world) {
  Bytes out(world.snapshot_size());
  EXPECT_EQ(world.save(out), out.size());
  return out;
}

std::vector<Row> rows_with_snapshots() {
  std::vector<Row> out;
  for (const Row& row : read_table(PLUMB_TEST_GOLDEN "/golden.csv")) {
    const bool is_reference = row.settings.find("method=springs") != std::string::npos ||
                              row.settings.find("method=multipliers") != std::string::npos ||
                              row.settings.find("method=featherstone") != std::string::npos;
    if (!is_reference) out.push_back(row);
  }
  return out;
}

class Snapshots : public testing::TestWithParam<Row> {
 protected:
  /// Steps from `first` to the end and returns the snapshots before every step of `at`, and that of the end.
  static std::map<std::uint32_t, Bytes> follow(RowRun& run, const Row& row, std::uint32_t first,
                                               std::uint32_t every) {
    std::map<std::uint32_t, Bytes> out;
    for (std::uint32_t step = first; step < row.steps; ++step) {
      if (step % every == 0) out[step] = save(run.world());
      run.step(step);
    }
    out[row.steps] = save(run.world());
    return out;
  }
  static void expect_same(const std::map<std::uint32_t, Bytes>& wanted,
                          const std::map<std::uint32_t, Bytes>& got, const char* what) {
    for (const auto& [step, bytes] : got) {
      const Bytes& other = wanted.at(step);
      std::size_t at = 0;
      while (at < bytes.size() && at < other.size() && (at == 8 || bytes[at] == other[at]))
        at = at == 8 ? 16 : at + 1;
      EXPECT_TRUE(bytes == other) << what << ": before step " << step << " bytes differ from " << at
                                  << " on, of " << bytes.size() << " and " << other.size();
      if (bytes != other) return;
    }
  }
};

TEST_P(Snapshots, LeadToTheSameBytesOnEveryMachine) {
  const Row& row = GetParam();
  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, {.projections = 1, .rods = 512});
  const Machine fast{.isa = best_isa()}, slow{.isa = Isa::scalar, .threads = 2, .executor = &eager};
  const std::uint32_t every = row.steps / 3;
  RowRun run(row, fast);
  const auto wanted = follow(run, row, 0, every);
  const std::uint64_t hash = run.world().state_hash();
  {
    RowRun straight(row, slow);
    expect_same(wanted, follow(straight, row, 0, every), "another machine");
  }
  RowRun fresh(row, slow);
  for (std::uint32_t step = 0; step < row.steps; step += every) {
    for (RowRun* const each : {&run, &fresh}) {
      each->world().restore(wanted.at(step));
      expect_same(wanted, follow(*each, row, step, every), each == &run ? "same world" : "fresh world");
      EXPECT_EQ(each->world().state_hash(), hash) << row.name << " from step " << step;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Snapshots, testing::ValuesIn(rows_with_snapshots()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace plumb::golden::PLUMB_TEST_FILE
