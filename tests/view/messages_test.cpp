// The page's own decoder reads what the server writes, and bad requests are refused with the reason.
#include "view/server/messages.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scenes/basics/files.hpp"
#include "scenes/runs/report.hpp"
#include "support/refusals.hpp"
#include "view/exhibits.hpp"
#include "view/inputs/request.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

using test::refusal;
using test::start_of;
using Numbers = nlohmann::json;

void expect_side(const Numbers& read, const Side& side, const Measured& measured) {
  EXPECT_EQ(read.at("hash"), scenes::hash_text(side.world().state_hash()));
  EXPECT_EQ(read.at("islands"), side.world().info().islands);
  EXPECT_EQ(read.at("substeps"), side.report().substeps);
  EXPECT_EQ(read.at("strainMax").get<float>(), static_cast<float>(measured.strain_max));
  EXPECT_EQ(read.at("kinetic").get<float>(), static_cast<float>(measured.energy.kinetic));
  EXPECT_EQ(read.at("distance").get<float>(), static_cast<float>(measured.distance));
  for (std::size_t i = 0; i < stage_names.size(); ++i)
    EXPECT_EQ(read.at("stagesUs")[i].get<float>(), static_cast<float>(side.stage_us()[i])) << stage_names[i];
  const std::vector<Vec3> positions = side.positions();
  ASSERT_EQ(read.at("positions").size(), 3 * positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_EQ(read.at("positions")[3 * i].get<float>(), static_cast<float>(positions[i].x));
    EXPECT_EQ(read.at("positions")[3 * i + 1].get<float>(), static_cast<float>(positions[i].y));
    EXPECT_EQ(read.at("positions")[3 * i + 2].get<float>(), static_cast<float>(positions[i].z));
  }
  const std::vector<float> strains = side.strains();
  ASSERT_EQ(read.at("values").size(), strains.size());
  for (std::uint32_t i = 0; i < strains.size(); ++i) {
    if (side.is_gone(i)) {
      EXPECT_EQ(read.at("values")[i], "none");
    } else {
      EXPECT_EQ(read.at("values")[i].get<float>(), strains[i]);
    }
  }
  EXPECT_EQ(read.at("flags")[0], 2) << "particle 0 is the anchor";
}

void expect_requests(const Numbers& asked) {
  const auto parsed = [&](int i) { return parse_request(asked[i].get<std::string>()); };
  EXPECT_EQ(parsed(0), (Request{.verb = Verb::pull, .number = 5, .at = {1, 2.5, -3}}));
  EXPECT_EQ(parsed(1), (Request{.verb = Verb::set, .side = 1, .name = "substeps", .value = "8"}));
  EXPECT_EQ(parsed(2), (Request{.verb = Verb::set, .name = "gravity", .value = "1.62"}));
  EXPECT_EQ(parsed(3),
            (Request{.verb = Verb::throw_ball, .value = "0.1", .at = {0, 1, 0}, .velocity = {3, 0, 0}}));
  EXPECT_EQ(parsed(4), (Request{.verb = Verb::reel, .name = "rod", .value = "-0.25", .number = 2}));
  EXPECT_EQ(parsed(5), (Request{.verb = Verb::cut, .number = 7}));
}

TEST(ViewMessages, PageReadsFramesAndIsRead) {
  if (std::system("node --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "node is missing";
  Exhibit exhibit(start_of("chain:links=6", {{.method = Method::direct}, {.method = Method::relax}}));
  test::run(exhibit, 20);
  exhibit.take({.verb = Verb::cut, .number = 4});
  test::run(exhibit, 5);
  std::vector<Measured> measured{measure(exhibit, 0), measure(exhibit, 1)};
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "plumb_view_messages";
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(PLUMB_VIEW_PAGE "/messages.js", folder / "messages.mjs",
                             std::filesystem::copy_options::overwrite_existing);
  std::ofstream(folder / "frame", std::ios::binary) << encode_frame(
      exhibit, {.playing = true, .reached = 0.5, .frame_us = 750, .hashed = true}, Values::strain, measured);
  const std::string command = "node " PLUMB_VIEW_TESTS "/decode.mjs " + (folder / "messages.mjs").string() +
                              " " + (folder / "frame").string() + " > " + (folder / "numbers").string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  const Numbers out = Numbers::parse(scenes::read_file((folder / "numbers").string()));
  const Numbers& frame = out.at("frame");
  EXPECT_EQ(frame.at("frame"), 25);
  EXPECT_EQ(frame.at("time").get<double>(), 25 * frame_length);
  EXPECT_EQ(frame.at("playing"), true);
  EXPECT_EQ(frame.at("replaying"), false);
  EXPECT_EQ(frame.at("reached").get<float>(), 0.5F);
  EXPECT_EQ(frame.at("frameUs").get<float>(), 750);
  ASSERT_EQ(frame.at("sides").size(), 2);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(frame.at("sides")[i].at("gone"), Numbers::array({4}));
    expect_side(frame.at("sides")[i], exhibit.sides()[i], measured[i]);
  }
  EXPECT_EQ(out.at("refused"), true) << "other bytes are no frame";
  expect_requests(out.at("asked"));
}

TEST(ViewMessages, BadRequestsAreRefusedWithTheReason) {
  const auto why = [](const std::string& text) { return refusal([&] { parse_request(text); }); };
  EXPECT_NE(why(R"({"do": "explode"})").find("'explode' is nothing that can be asked for"),
            std::string::npos);
  EXPECT_NE(why(R"({"name": "x"})").find("do"), std::string::npos);
  for (const char* text :
       {"", "{", "[]", "7", "\xff\xfe", R"({"do": "pull", "number": -1})",
        R"({"do": "pull", "number": 1e30})", R"({"do": "pull", "number": 1.5})",
        R"({"do": "pull", "at": [0, NaN, 0]})", R"({"do": "pull", "at": [0, 1e999, 0]})",
        R"({"do": "pull", "at": [0, 0]})", R"({"do": "pull", "at": "here"})", R"({"do": "set", "name": 4})",
        R"({"do": "set", "more": 4})", R"({"do": "set", "do": "cut"})"})
    EXPECT_NE(why(text), "") << text;
  EXPECT_NE(why(std::string(1 << 22, '[')), "") << "deep";
  EXPECT_NE(why(R"({"do": ")" + std::string(1 << 22, 'x') + R"("})"), "") << "long";
}

TEST(ViewMessages, RefusedInputsChangeNothing) {
  Exhibit exhibit(start_of("chain:links=6", {{.method = Method::direct}}));
  test::run(exhibit, 3);
  const std::uint64_t before = exhibit.sides()[0].world().state_hash();
  const auto pull = [](std::uint32_t number, Vec3 at) {
    return Request{.verb = Verb::pull, .number = number, .at = at};
  };
  for (const Request& request :
       {pull(100, {}), pull(3, {0, std::nan(""), 0}), Request{.verb = Verb::cut, .number = 6},
        Request{.verb = Verb::fix, .number = 99}, Request{.verb = Verb::pause},
        Request{.verb = Verb::set, .side = 3, .name = "substeps", .value = "2"}, test::set("substeps", "0"),
        test::set("substeps", "99999999999"), test::set("method", "magic"), test::set("gravity", "nan"),
        test::set("drag", "-1"), test::set("end_mass", "0"), test::set("colour", "red"),
        Request{.verb = Verb::reel, .name = "rope", .value = "1"},
        Request{.verb = Verb::throw_ball, .value = "0.1"}})
    EXPECT_NE(refusal([&] { exhibit.take(request); }), "") << request_json(request).dump();
  EXPECT_TRUE(exhibit.taken().empty());
  EXPECT_EQ(exhibit.sides()[0].world().state_hash(), before);
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
