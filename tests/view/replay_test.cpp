// Recorded inputs give the same bits again, in memory and through a file, with all settings that change bits.
#include "view/inputs/replay.hpp"

#include <gtest/gtest.h>

#include "support/refusals.hpp"
#include "view/exhibits.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

using test::refusal;
using test::run;
using test::set;

void play(Exhibit& exhibit) {
  run(exhibit, 7);
  exhibit.take({.verb = Verb::pull, .number = 9, .at = {0.5, 0.4, 0.3}});
  run(exhibit, 5);
  exhibit.take({.verb = Verb::pull, .number = 9, .at = {0.2, 0.6, 0.1}});
  exhibit.take(set("gravity", "3.5"));
  exhibit.take({.verb = Verb::set, .side = 1, .name = "gradient", .value = "old"});
  run(exhibit, 6);
  exhibit.take({.verb = Verb::release});
  exhibit.take({.verb = Verb::cut, .number = 6});
  exhibit.take(set("drag", "0.3"));
  exhibit.take({.verb = Verb::reel, .name = "rod", .value = "-0.2", .number = 1});
  run(exhibit, 9);
  exhibit.take({.verb = Verb::fix, .number = 4});
  exhibit.take(set("end_mass", "7"));
  run(exhibit, 12);
  exhibit.take({.verb = Verb::free, .number = 4});
}

TEST(ViewReplay, HasTheSameBitsThroughItsFile) {
  Settings floats{.method = Method::relax, .precision = Precision::single, .omega = 1.3, .substeps = 3};
  floats.stop.sweeps = 17;
  Exhibit exhibit(
      test::start_of("chain:links=12,end_mass=5", {{.method = Method::direct, .substeps = 4}, floats}));
  play(exhibit);
  const Replay replay = parse_replay(format_replay(exhibit), "r");
  EXPECT_EQ(replay.frames, exhibit.frame());
  ASSERT_EQ(replay.inputs.size(), exhibit.taken().size());
  for (std::size_t i = 0; i < replay.inputs.size(); ++i)
    EXPECT_EQ(replay.inputs[i].request, exhibit.taken()[i].request);
  const Exhibit again = repeat(replay);
  EXPECT_EQ(hashes_of(again), hashes_of(exhibit));
  EXPECT_EQ(hashes_of(again), replay.hashes);
  EXPECT_EQ(format_replay(again), format_replay(exhibit));
  Replay other = replay;
  other.inputs.pop_back();
  other.inputs.front().request.at.x += 1e-9;
  EXPECT_NE(hashes_of(repeat(other)), replay.hashes) << "inputs decide";
}

TEST(ViewReplay, KeepsAllSettings) {
  Settings s{.method = Method::relax,
             .precision = Precision::single,
             .gradient = Gradient::old,
             .mass = MassModel::lumped,
             .weights = Weights::equal,
             .order = SweepOrder::jacobi,
             .omega = 0.1 + 0.2,
             .substeps = 3,
             .time_order = 4,
             .accuracy = 1e-3,
             .most_work = 12345,
             .stop = {.sweeps = 7, .tolerance = 1e-5},
             .integrator = Integrator::rk2,
             .springs = {SpringModel::particles, 1e3, 0.3},
             .multipliers = {Stabilization::baumgarte, 3},
             .sleep_time = 0.7,
             .layout = LayoutChoice::soa};
  s.contact.length_scale = 0.01;
  const std::string text = all_settings_json(s).dump();
  Exhibit exhibit(test::start_of("chain:links=3", {{.method = Method::direct}}));
  std::string file = format_replay(exhibit);
  const std::string plain = all_settings_json({.method = Method::direct}).dump();
  // The file is indented, so that its settings are read back by name.
  Replay replay = parse_replay(file, "r");
  EXPECT_EQ(all_settings_json(replay.start.sides[0].settings).dump(), plain);
  Settings back;
  for (const auto& [name, value] : scenes::members_of(text))
    read_setting(back, name, std::string_view(value).substr(1, value.size() - 2));
  EXPECT_EQ(all_settings_json(back).dump(), text);
  EXPECT_EQ(back.omega, s.omega);
  EXPECT_EQ(back.springs, s.springs);
  EXPECT_EQ(back.multipliers, s.multipliers);
  EXPECT_EQ(back.mass, s.mass);
  EXPECT_EQ(back.integrator, s.integrator);
  EXPECT_EQ(back.layout, s.layout);
  EXPECT_EQ(back.contact, s.contact);
}

TEST(ViewReplay, IsRefusedWithTheReason) {
  const auto why = [](const std::string& text) { return refusal([&] { parse_replay(text, "file.json"); }); };
  EXPECT_NE(why("{}").find("file.json"), std::string::npos);
  Exhibit exhibit(test::start_of("chain:links=3", {{.method = Method::direct}}));
  exhibit.take(set("drag", "1"));
  const std::string good = format_replay(exhibit);
  EXPECT_EQ(why(good), "");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string out = good;
    const std::size_t at = out.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return out.replace(at, from.size(), to);
  };
  EXPECT_NE(why(changed("\"set\"", "\"pause\"")), "");
  EXPECT_NE(why(changed("\"direct\"", "\"magic\"")), "");
  EXPECT_NE(why(changed("\"plumb_replay\": 1", "\"plumb_replay\": 9")), "");
  EXPECT_NE(why(changed("\"frame\": 0", "\"frame\": -1")), "");
  EXPECT_NE(why(good.substr(0, good.size() / 2)), "");
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
