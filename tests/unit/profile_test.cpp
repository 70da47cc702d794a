#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "plumb/error.hpp"
#include "profile/cachegrind.hpp"
#include "profile/caches.hpp"
#include "profile/measure.hpp"
#include "profile/output.hpp"
#include "profile/perf_counters.hpp"
#include "profile/work.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
namespace {

// Two functions of two files, in the format of cachegrind's manual.
constexpr const char* cachegrind_file =
    "desc: I1 cache:         32768 B, 64 B, 8-way associative\n"
    "desc: D1 cache:         32768 B, 64 B, 8-way associative\n"
    "desc: LL cache:         1048576 B, 64 B, 16-way associative\n"
    "cmd: plumb profile worker chain\n"
    "events: Ir I1mr ILmr Dr D1mr DLmr Dw D1mw DLmw\n"
    "fl=sweep.cpp\n"
    "fn=sweep\n"
    "10 700 1 1 300 40 4 100 20 2\n"
    "11 50 0 0 20 2 1 10 1 1\n"
    "fl=main.cpp\n"
    "fn=main\n"
    "3 250 2 1 80 8 5 40 4 2\n"
    "summary: 1000 3 2 400 50 10 150 25 5\n";

/// A folder of its own, gone with the test.
class ProfileFolder : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    const auto file = folder_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text << "\n";
  }
  void write_cache(int index, const char* level, const char* type, const char* size, const char* ways) {
    const std::string one = "index" + std::to_string(index) + "/";
    write(one + "level", level);
    write(one + "type", type);
    write(one + "size", size);
    write(one + "ways_of_associativity", ways);
    write(one + "coherency_line_size", "64");
  }
  TemporaryFolder folder_;
};

TEST(Cachegrind, TotalsAreThoseOfTheSummary) {
  const CachegrindTotals totals = parse_cachegrind(cachegrind_file);
  EXPECT_EQ(totals.size(), 9u);
  EXPECT_EQ(totals.at("Ir"), 1000u);
  EXPECT_EQ(totals.at("D1mr"), 50u);
  EXPECT_EQ(totals.at("DLmw"), 5u);
}

TEST(Cachegrind, EventsThatWereNotCountedAreNotThere) {
  const CachegrindTotals totals = parse_cachegrind("events: Ir\nsummary: 12345678901234\n");
  EXPECT_EQ(totals.at("Ir"), 12345678901234u);
  EXPECT_FALSE(totals.contains("D1mr"));
}

TEST(Cachegrind, RefusesWhatIsNoOutputFile) {
  EXPECT_THROW(parse_cachegrind(""), InputError);
  EXPECT_THROW(parse_cachegrind("events: Ir Dr\n"), InputError);
  EXPECT_THROW(parse_cachegrind("summary: 1 2\n"), InputError);
  EXPECT_THROW(parse_cachegrind("events: Ir Dr\nsummary: 1\n"), InputError);
  EXPECT_THROW(parse_cachegrind("events: Ir Dr\nsummary: 1 many\n"), InputError);
  EXPECT_THROW(parse_cachegrind("events: Ir\nsummary: -1\n"), InputError);
}

TEST(ProfileCaches, SimulatedCachesHaveSetsThatAreAPowerOfTwo) {
  // Of 53248 sets, 11 ways: 32768 sets and 18 ways are the nearest below.
  const Cache odd{3, 36608 * 1024, 11, 64};
  const Cache simulated = nearest_simulated(odd);
  EXPECT_EQ(simulated.bytes, std::uint64_t{32768} * 18 * 64);
  EXPECT_EQ(simulated.ways, 18u);
  EXPECT_EQ(simulated.level, 3u);
  const Cache even = nearest_simulated({1, 32 * 1024, 8, 64});
  EXPECT_EQ(even.bytes, 32u * 1024);
  EXPECT_EQ(even.ways, 8u);
  // 12 ways of 64 sets are 48 kB, as they are.
  EXPECT_EQ(nearest_simulated({1, 48 * 1024, 12, 64}).bytes, 48u * 1024);
  EXPECT_THROW(nearest_simulated({1, 48 * 1024, 12, 96}), InputError);
  EXPECT_THROW(nearest_simulated({}), InputError);
}

TEST_F(ProfileFolder, CachesAreReadFromTheSystemsFilesWithoutThoseOfInstructions) {
  write_cache(0, "1", "Data", "48K", "12");
  write_cache(1, "1", "Instruction", "32K", "8");
  write_cache(2, "2", "Unified", "1M", "16");
  write_cache(3, "3", "Unified", "36608K", "11");
  const auto caches = read_caches(folder_.path());
  ASSERT_EQ(caches.size(), 3u);
  EXPECT_EQ(caches[0].bytes, 48u * 1024);
  EXPECT_EQ(caches[0].ways, 12u);
  EXPECT_EQ(caches[1].bytes, 1024u * 1024);
  EXPECT_EQ(pick_caches(caches, 2).last.level, 2u);
  EXPECT_EQ(pick_caches(caches, 9).last.level, 3u);
  EXPECT_EQ(pick_caches(caches, 9).first.level, 1u);
  EXPECT_FALSE(pick_caches(caches, 9).assumed);
}

TEST(ProfileCaches, WithoutAnswerCommonSizesAreMarkedAsAssumed) {
  const CachePair pair = pick_caches({}, 3);
  EXPECT_TRUE(pair.assumed);
  EXPECT_GT(pair.last.bytes, pair.first.bytes);
}

TEST(PerfCounters, SharedCountersAreScaledByTheTimeTheyRan) {
  // Ran a quarter of the time: what it saw counts four times.
  const auto scaled = scaled_count({100, 1000, 1000}, {600, 5000, 2000});
  ASSERT_TRUE(scaled);
  EXPECT_DOUBLE_EQ(*scaled, 2000);
  EXPECT_DOUBLE_EQ(scaled_count({0, 0, 0}, {7, 50, 50}).value(), 7);
  EXPECT_FALSE(scaled_count({5, 100, 100}, {5, 900, 100}));  // never ran
}

TEST(PerfCounters, ARefusalIsAReasonAndNoNumber) {
  PerfCounters counters([](perf_event_attr&, int) { return -EACCES; });
  EXPECT_FALSE(counters.has_any());
  EXPECT_FALSE(counters.has(HardwareEvent::ll_misses));
  EXPECT_NE(counters.refusal(HardwareEvent::cycles).find("perf_event_paranoid"), std::string::npos);
  // One reason for all four, said once.
  const std::string said = counters.refusals();
  EXPECT_NE(said.find("instructions, cycles, L1D read misses, last-level cache misses: "), std::string::npos);
  EXPECT_EQ(said.find("forbids"), said.rfind("forbids"));
  counters.start();
  for (const auto& count : counters.stop()) EXPECT_FALSE(count);
}

TEST(PerfCounters, WhatDoesNotFitTheGroupIsTriedAlone) {
  std::vector<int> groups;
  const PerfCounters counters([&](perf_event_attr&, int group) {
    groups.push_back(group);
    return group >= 0 ? -EINVAL : -ENOENT;
  });
  // Nothing opens, so every event is asked for as the first of a group, once.
  EXPECT_EQ(groups, std::vector<int>(hardware_events, -1));
  EXPECT_NE(counters.refusal(HardwareEvent::instructions).find("no such counter"), std::string::npos);
}

TEST(PerfCounters, OnThisMachineEveryEventCountsOrSaysWhyNot) {
  PerfCounters counters;
  counters.start();
  const auto counts = counters.stop();
  for (std::size_t i = 0; i < hardware_events; ++i) {
    const auto event = static_cast<HardwareEvent>(i);
    EXPECT_NE(counters.has(event), !counters.refusal(event).empty());
    if (!counters.has(event)) {
      EXPECT_FALSE(counts[i]);
    }
  }
}

TEST(ProfileMeasure, DifferencesLeaveOutWhatBothRunsDid) {
  // 1000 misses of set-up; 3 per unit.
  const Counts shorter{.instructions = 5000, .cycles = {}, .l1d_read_misses = 1300, .l1d_write_misses = 0};
  const Counts longer{.instructions = 9000, .cycles = 1e6, .l1d_read_misses = 1600, .l1d_write_misses = 0};
  const Counts per_unit = counts_per_unit(shorter, 100, longer, 200);
  EXPECT_DOUBLE_EQ(per_unit.instructions.value(), 40);
  EXPECT_DOUBLE_EQ(per_unit.l1d_read_misses.value(), 3);
  EXPECT_DOUBLE_EQ(per_unit.l1d_write_misses.value(), 0);  // counted, and none
  EXPECT_FALSE(per_unit.cycles);                           // only one run has it
  EXPECT_FALSE(per_unit.ll_misses);
  EXPECT_THROW(counts_per_unit(shorter, 100, longer, 100), InputError);
}

// Under load the shorter run may take longer than the one that did twice as much.
TEST(ProfileMeasure, ACostThatIsNotPositiveIsNotMeasurable) {
  EXPECT_EQ(measurable_cost(0.4), 0.4);
  EXPECT_FALSE(measurable_cost(-2.57));
  EXPECT_FALSE(measurable_cost(0.0));
  EXPECT_FALSE(measurable_cost({}));
}

TEST(ProfileMeasure, MediansAreOfWhatIsThere) {
  const std::vector<Counts> samples{
      {.ll_misses = 3.0}, {.cycles = 8.0, .ll_misses = 1.0}, {.ll_misses = 2.0}};
  const Counts median = median_of(samples);
  EXPECT_DOUBLE_EQ(median.ll_misses.value(), 2);
  EXPECT_DOUBLE_EQ(median.cycles.value(), 8);
  EXPECT_FALSE(median.instructions);
}

TEST(ProfileMeasure, CountersComeBeforeCachegrindAndNothingIsRefused) {
  const Means both{true, "", "/usr/bin/valgrind"}, simulated{false, "forbidden", "/usr/bin/valgrind"},
      nothing{false, "forbidden", {}};
  EXPECT_EQ(choose_way({}, both), Way::counters);
  EXPECT_EQ(choose_way({}, simulated), Way::cachegrind);
  EXPECT_EQ(choose_way({}, nothing), Way::none);
  EXPECT_EQ(choose_way(Way::cachegrind, both), Way::cachegrind);
  EXPECT_THROW(choose_way(Way::counters, simulated), InputError);
  EXPECT_THROW(choose_way(Way::cachegrind, nothing), InputError);
  EXPECT_NE(advice(nothing).find("package valgrind"), std::string::npos);
  EXPECT_NE(advice(nothing).find("forbidden"), std::string::npos);
}

/// profile_json() as another program reads it.
nlohmann::ordered_json parsed(const Profile& profile) {
  return nlohmann::ordered_json::parse(profile_json(profile).dump());
}

/// A row without counts, as without counters and valgrind.
Profile uncounted() {
  Profile profile;
  profile.caches = {{1, 32 * 1024, 8, 64}, {2, 1024 * 1024, 16, 64}, false};
  ProfileRow row;
  row.profile_case = {"chain",
                      SceneSize::beyond,
                      {.scene = "chain:links=9,end_mass=2", .settings = {.method = Method::relax}}};
  row.layout = "soa";
  row.is_auto = true;
  row.rods = 9;
  row.state_bytes = 2048;
  row.model_bytes = 64.5;
  profile.rows = {row};
  return profile;
}

TEST(ProfileOutput, WhatIsNotAvailableIsNoZero) {
  EXPECT_EQ(count_cell({}), "—");
  EXPECT_EQ(number_cell({}), "—");
  EXPECT_EQ(count_cell(0.0), "0.000");
  EXPECT_EQ(count_cell(-1e-6), "0.000");
  EXPECT_EQ(count_cell(0.4375), "0.438");

  const Profile profile = uncounted();
  const std::string table = relax_table(profile).to_text();
  const std::string row = table.substr(table.find("chain:"));
  EXPECT_NE(row.find("soa (auto)"), std::string::npos);
  EXPECT_NE(row.find("64.5"), std::string::npos);
  std::size_t dashes = 0;
  for (std::size_t at = row.find("—"); at != std::string::npos; at = row.find("—", at + 1)) ++dashes;
  EXPECT_EQ(dashes, 6u);
  EXPECT_NE(row.find("not measurable under this noise"), std::string::npos);

  const std::string csv = profile_csv(profile);
  EXPECT_NE(csv.find("\"chain:links=9,end_mass=2\",> L2,soa,1,float,scalar,9,2048,64.5,,,,,,\n"),
            std::string::npos);

  const nlohmann::ordered_json json = parsed(profile);
  EXPECT_TRUE(json["simulated"].is_null());
  const auto& one = json["rows"][0];
  for (const char* key :
       {"ns", "instructions", "cycles", "l1d_read_misses", "l1d_write_misses", "ll_misses"}) {
    ASSERT_TRUE(one.contains(key)) << key;
    EXPECT_TRUE(one[key].is_null()) << key;
  }
  EXPECT_EQ(one["model_bytes"], 64.5);
  EXPECT_EQ(draw_misses(profile, MissKind::l1d_read, SweepOrder::gauss_seidel), "");
}

TEST(ProfileOutput, CountsThatAreZeroAreZeros) {
  Profile profile = uncounted();
  profile.way = Way::cachegrind;
  profile.simulated = profile.caches;
  profile.rows[0].counts.ll_misses = 0;
  EXPECT_TRUE(profile_csv(profile).ends_with(",,,,,0\n"));
  EXPECT_EQ(parsed(profile)["rows"][0]["ll_misses"], 0.0);
  EXPECT_EQ(parsed(profile)["simulated"]["ll"]["ways"], 16);
  EXPECT_NE(way_text(profile).find("Simulated by cachegrind"), std::string::npos);
}

WorkPlan tiny(Method method) {
  WorkPlan plan{.scene = "ensemble:chains=3,links=4", .settings = {}, .frames = 2};
  plan.settings.method = method;
  plan.settings.threads = 1;
  if (method == Method::relax) plan.settings.stop.sweeps = 8;
  return plan;
}

TEST(ProfileWork, ARelaxingWorkerSaysHowOftenRodsWereProjected) {
  const WorkDone done = do_work(tiny(Method::relax));
  EXPECT_EQ(done.projections, 2u * 8 * 12);  // frames, sweeps, rods
  EXPECT_EQ(done.rod_newtons, 0u);
  EXPECT_EQ(do_work(repeated(tiny(Method::relax), 2)).units(), 2 * done.units());
}

TEST(ProfileWork, ADirectWorkerSaysHowOftenRodsWerePartOfANewtonStep) {
  const WorkDone done = do_work(tiny(Method::direct));
  EXPECT_EQ(done.projections, 0u);
  EXPECT_GE(done.rod_newtons, 2u * 12);  // at least one Newton step a frame
  EXPECT_EQ(done.rod_newtons % 4, 0u);
  EXPECT_GT(do_work(repeated(tiny(Method::direct), 2)).units(), done.units());
}

TEST(ProfileWork, WhatAWorkerPrintsIsReadBack) {
  const WorkDone done = parse_work(to_json_line({.projections = 1234567890123, .rod_newtons = 7}));
  EXPECT_EQ(done.projections, 1234567890123u);
  EXPECT_EQ(done.rod_newtons, 7u);
  EXPECT_THROW(parse_work(""), InputError);
  EXPECT_THROW(parse_work("plumb: no such scene"), InputError);
  EXPECT_THROW(parse_work(R"({"projections": -1, "rod_newtons": 0})"), InputError);
}

TEST(ProfileWork, CasesCoverShapesLayoutsAndSizesOnce) {
  const CachePair caches{{1, 32 * 1024, 8, 64}, {2, 1024 * 1024, 16, 64}, false};
  std::set<std::string> seen;
  std::size_t relaxed = 0;
  for (const ProfileCase& one : list_cases({.caches = caches, .isa = Isa::sse2})) {
    std::string words;
    for (const std::string& word : worker_arguments(one.plan)) words += word + " ";
    EXPECT_TRUE(seen.insert(words).second) << words;
    EXPECT_NE(words.find("--isa sse2"), std::string::npos);
    EXPECT_EQ(one.plan.settings.threads, 1u);
    if (one.plan.settings.method != Method::relax) continue;
    ++relaxed;
    const std::string order = "--order " + std::string(to_string(one.plan.settings.order));
    EXPECT_NE(words.find(order), std::string::npos) << words;
    EXPECT_EQ(one.plan.settings.stop.sweeps % 8, 0u);  // whole runs through memory of pipelined sweeps
    EXPECT_GT(one.plan.settings.stop.sweeps, 0u);
  }
  EXPECT_EQ(relaxed, 2 * 4u * (1 + 3 + 3));  // orders, shapes; inside the first cache one layout alone
  EXPECT_EQ(seen.size(), relaxed + 4);
}

TEST(ProfileWork, ScenesFitTheCachesTheyAreMadeFor) {
  const CachePair caches{{1, 32 * 1024, 8, 64}, {2, 256 * 1024, 16, 64}, false};
  const CaseChoice choice{.caches = caches, .isa = Isa::scalar, .quick = true};
  const auto cases = list_cases(choice);
  const auto rows = measure_cases({cases.front()}, Way::none, {}, caches, [](std::size_t) {});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_LT(rows[0].state_bytes.value(), caches.first.bytes);
  EXPECT_GT(rows[0].model_bytes, 0);
  EXPECT_TRUE(rows[0].is_auto);
  EXPECT_TRUE(rows[0].ns);
  EXPECT_FALSE(rows[0].counts.ll_misses);
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
