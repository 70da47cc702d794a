// The bits that a scene has after some steps, against a table that is committed: whatever the instruction set
// and the number of threads, and whatever was changed in the code since.
//
// A row that is meant to change is replaced by the one that the failing test prints. A whole new table is
// written with
//   PLUMB_GOLDEN_TABLE=new.csv bin/test_golden --gtest_filter='Table.*'

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "golden/run.hpp"
#include "golden/settings_text.hpp"
#include "golden/table.hpp"
#include "scenes/basics/files.hpp"
#include "support/executors.hpp"
#include "support/sanitizers.hpp"
#include "threads/sharing.hpp"

namespace plumb::golden::PLUMB_TEST_FILE {
namespace {

constexpr const char* table_path = PLUMB_TEST_GOLDEN "/golden.csv";

/// Sanitizers look at accesses, not at bits, and are slow: the slowest and the fastest set do.
std::vector<Isa> isas_to_run() {
  std::vector<Isa> isas;
  for (const Isa isa : all_isas())
    if (is_supported(isa) && (!test::sanitized || isa == Isa::scalar || isa == best_isa()))
      isas.push_back(isa);
  return isas;
}

class Golden : public testing::TestWithParam<Row> {};

TEST_P(Golden, BitsAreThoseOfTheTable) {
  const Row& row = GetParam();
  test::PoolExecutor pool(2);
  // Threads share even the small scenes of the table.
  detail::EagerExecutor eager(pool, {.projections = 1, .rods = 512});
  Row fresh = row;
  bool first = true, agree = true;
  for (const Isa isa : isas_to_run())
    for (const unsigned threads : {1u, 2u}) {
      const Outcome got =
          run_row(row, {.isa = isa, .threads = threads, .executor = threads == 2 ? &eager : nullptr});
      ASSERT_TRUE(got.finite) << row.name;
      ASSERT_EQ(got.total.frozen_islands, 0u) << row.name;
      ASSERT_TRUE(!got.has_shapes || got.total.contact_points > 0) << row.name << ": nothing touched";
      ASSERT_NE(got.hashes.motion, got.before.motion) << row.name << ": nothing moved";
      if (first) fresh.wanted = got.hashes;
      agree = agree && got.hashes == fresh.wanted;
      first = false;
      EXPECT_EQ(got.hashes.state, row.wanted.state) << to_string(isa) << ", " << threads << " threads";
      EXPECT_EQ(got.hashes.motion, row.wanted.motion) << to_string(isa) << ", " << threads << " threads";
    }
  if (!agree) FAIL() << row.name << ": instruction sets or threads differ among themselves";
  if (fresh.wanted != row.wanted) FAIL() << "the row with its new hashes is\n" << format_row(fresh);
}

INSTANTIATE_TEST_SUITE_P(Every, Golden, testing::ValuesIn(read_table(table_path)),
                         [](const auto& test) { return test.param.name; });

TEST(Table, HasEveryChoice) {
  std::set<std::string> words;
  for (const Row& row : read_table(table_path))
    for (const std::string& word : split(row.settings, ' ')) words.insert(word);
  for (const Choices& choices : list_choices())
    for (const std::string& value : choices.values)
      EXPECT_TRUE(words.contains(choices.key + "=" + value)) << choices.key << "=" << value;
}

TEST(Table, NamesEachRowOnce) {
  std::set<std::string> names;
  for (const Row& row : read_table(table_path)) EXPECT_TRUE(names.insert(row.name).second) << row.name;
}

TEST(Table, IsWrittenIfAskedFor) {
  const char* const path = std::getenv("PLUMB_GOLDEN_TABLE");
  if (path == nullptr) GTEST_SKIP() << "PLUMB_GOLDEN_TABLE names no file";
  std::string text;
  for (const std::string& line : read_lines(table_path)) {
    if (!is_row(line)) {
      text += line + '\n';
      continue;
    }
    Row row = parse_row(line);
    row.wanted = run_row(row, {}).hashes;
    text += format_row(row) + '\n';
  }
  scenes::write_file(path, text);
}

}  // namespace
}  // namespace plumb::golden::PLUMB_TEST_FILE
