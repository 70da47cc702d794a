#include "scenes/basics/json.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

using Library = nlohmann::ordered_json;

// What plumb writes is, letter for letter, what the library that reads it back would write.
TEST(Json, IsWrittenAsTheLibraryWritesIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  Json ours{{"text", "a \"b\"\n\\ \u00b5"},
            {"none", nullptr},
            {"nan", nan},
            {"yes", true},
            {"third", 1.0 / 3},
            {"one", 1.0},
            {"small", 1e-300},
            {"large", 1e22},
            {"least", std::int64_t{-5}},
            {"most", most},
            {"inner", {{"a", 1}, {"b", {{"c", 2u}}}}}};
  Library theirs{{"text", "a \"b\"\n\\ \u00b5"},
                 {"none", nullptr},
                 {"nan", nan},
                 {"yes", true},
                 {"third", 1.0 / 3},
                 {"one", 1.0},
                 {"small", 1e-300},
                 {"large", 1e22},
                 {"least", std::int64_t{-5}},
                 {"most", most},
                 {"inner", {{"a", 1}, {"b", {{"c", 2u}}}}}};
  ours["list"] = Json::array_of({1.5, -0.0});
  theirs["list"] = {1.5, -0.0};
  ours["empty"] = Json::array();
  theirs["empty"] = Library::array();
  ours["rows"].push_back({{"x", 1}});
  theirs["rows"].push_back({{"x", 1}});
  EXPECT_EQ(ours.dump(), theirs.dump());
  EXPECT_EQ(ours.dump_indented(), theirs.dump(2));
}

TEST(Json, WritesBytesThatAreNoTextAsUnknownCharacters) {
  EXPECT_EQ(Json("\x89PNG").dump(), "\"\ufffdPNG\"");
  EXPECT_EQ(Json{std::string("last read: '\xc3'")}.dump(), "\"last read: '\ufffd'\"");
}

TEST(Json, KeepsTheOrderOfItsMembersAndTheLastValueOfEach) {
  Json json{{"b", 1}, {"a", 2}};
  json["b"] = 3;
  json.update({{"c", 4}, {"a", Json(std::optional<double>())}});
  EXPECT_EQ(json.dump(), R"({"b":3,"a":null,"c":4})");
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
