// What a show answers, without a server.

#include "view/server/show.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "scenes/spec.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

/// A show that writes down what it says.
struct Written {
  std::vector<std::string> texts{};
  Show show;

  explicit Written(Start start)
      : show(Exhibit(std::move(start)),
             {[this](std::string text) { texts.push_back(std::move(text)); }, [](std::string) {}}) {
    show.greet();
  }
  /// Returns the last message of a kind.
  std::string last(const std::string& kind) const {
    for (std::size_t i = texts.size(); i-- > 0;)
      if (texts[i].find("\"kind\":\"" + kind + "\"") != std::string::npos) return texts[i];
    return "";
  }
};

/// Returns the thesis's comparison of a scene.
Start compared(const std::string& scene) {
  return {.name = scene, .scene = scenes::load_scene(scene), .sides = comparison("mass against equal").sides};
}

TEST(ViewShow, GoesBackToDefaults) {
  Written page(compared("winch:rods=4,load=10"));
  const std::string scene = page.last("scene"), sides = page.last("sides");
  for (const char* const request :
       {R"({"do":"set","name":"end_mass","value":"300"})", R"({"do":"set","name":"gravity","value":"3"})",
        R"({"do":"set","side":1,"name":"sweeps","value":"3"})", R"({"do":"reset"})", R"({"do":"step"})"})
    page.show.obey(request);
  EXPECT_NE(page.last("sides"), sides);
  page.show.obey(R"({"do":"defaults"})");
  EXPECT_EQ(page.last("sides"), sides);
  EXPECT_EQ(page.last("scene"), scene);
  page.show.obey(R"({"do":"set","name":"gravity","value":"3"})");
  page.show.obey(R"({"do":"load","name":"chain:links=3"})");
  page.show.obey(R"({"do":"set","name":"gravity","value":"5"})");
  page.show.obey(R"({"do":"defaults"})");
  EXPECT_NE(page.last("scene").find("chain:links=3"), std::string::npos)
      << "they are those of the scene of now";
  EXPECT_NE(page.last("sides").find("\"gravity\":9.81"), std::string::npos);
}

TEST(ViewShow, MovesByOneWorldWhatNotAllOfThemMove) {
  Written page(compared("winch"));
  page.show.obey(R"({"do":"load","name":"wire"})");
  EXPECT_NE(page.last("scene").find("wire"), std::string::npos);
  EXPECT_EQ(page.last("sides").find("by mass"), std::string::npos);
  EXPECT_NE(page.last("note").find("no bends"), std::string::npos) << "it says why";
  EXPECT_NE(page.last("note").find("\"refused\":false"), std::string::npos);
  page.show.obey(R"({"do":"load","name":"nothing"})");
  EXPECT_NE(page.last("note").find("\"refused\":true"), std::string::npos);
  EXPECT_NE(page.last("scene").find("wire"), std::string::npos);
}

TEST(ViewShow, BeginsLargeScenesWithOneWorld) {
  Written page(compared("winch"));
  const auto load = [&](const std::string& scene) {
    page.show.obey(R"({"do":"load","name":")" + scene + "\"}");
    return page.last("scene").find(scene) != std::string::npos;
  };
  const auto shows = [&](const std::string& name) {
    return page.last("sides").find(R"("comparison":")" + name + "\"") != std::string::npos;
  };
  page.show.obey(R"({"do":"set","side":1,"name":"sweeps","value":"3"})");
  EXPECT_TRUE(load("net") && shows("mass against equal"));
  for (const char* const scene : {"graph", "heap", "wire", "heap"}) {
    EXPECT_TRUE(load(scene) && shows("one world")) << scene;
    EXPECT_NE(page.last("note").find("One world, since"), std::string::npos) << "it says so";
    EXPECT_NE(page.last("note").find("\"refused\":false"), std::string::npos);
  }
  page.show.obey(R"({"do":"defaults"})");
  EXPECT_TRUE(shows("one world"));
  EXPECT_TRUE(load("rope") && shows("mass against equal"));
  EXPECT_NE(page.last("sides").find(R"("sweeps":"3")"), std::string::npos) << "with what was set";
  EXPECT_TRUE(load("heap") && shows("one world"));
  page.show.obey(R"({"do":"compare","name":"relax against direct"})");
  EXPECT_TRUE(shows("relax against direct"));
  EXPECT_TRUE(load("heap:ropes=17") && shows("relax against direct")) << "who asked for them keeps them";
  EXPECT_TRUE(load("rope") && shows("relax against direct"));
  EXPECT_TRUE(load("heap") && shows("one world"));
  page.show.obey(R"({"do":"compare","name":"one world"})");
  EXPECT_TRUE(load("rope") && shows("one world")) << "it was chosen";
}

TEST(ViewShow, StartsAsItIsAsked) {
  Written page(compared("heap"));
  EXPECT_NE(page.last("sides").find("mass against equal"), std::string::npos);
  page.show.obey(R"({"do":"reset"})");
  EXPECT_NE(page.last("sides").find("mass against equal"), std::string::npos);
}

TEST(ViewShow, NamesWorldsByWhatTheyAreNow) {
  Written page(compared("winch:rods=4,load=10"));
  const auto says = [&](const std::string& text) {
    return page.last("sides").find(text) != std::string::npos;
  };
  const auto set = [&](const std::string& name, const std::string& value) {
    page.show.obey(R"({"do":"set","side":1,"name":")" + name + R"(","value":")" + value + "\"}");
  };
  EXPECT_TRUE(says(R"("comparison":"mass against equal")") && says("all at once.\"") &&
              says(R"("hint":"Move End mass.")"));
  set("sweeps", "3");
  EXPECT_TRUE(says(R"("name":"by mass")") && says(R"("comparison":"mass against equal")"));
  set("weights", "equal");
  EXPECT_TRUE(says(R"("name":"by mass · weights equal")"));
  EXPECT_TRUE(says(R"("comparison":"")") && says(R"("about":"")") && says(R"("hint":"")"))
      << "the sentences would be wrong";
  set("method", "direct");
  EXPECT_TRUE(says(R"("name":"by mass · direct")")) << "what nothing reads is not named";
  page.show.obey(R"({"do":"reset"})");
  EXPECT_TRUE(says(R"("name":"by mass · direct")")) << "it starts so now";
  page.show.obey(R"({"do":"add","side":1})");
  EXPECT_TRUE(says(R"("name":"by mass again · direct")"));
  page.show.obey(R"({"do":"record"})");
  const std::string replay = page.last("replay");
  page.show.obey(R"({"do":"defaults"})");
  EXPECT_TRUE(says(R"("name":"by mass")") && !says("again ·"));
  page.show.obey(R"({"do":"load","name":"r.json","value":)" + replay.substr(replay.find("\"text\":") + 7));
  EXPECT_TRUE(says(R"("name":"by mass · direct")")) << "a replay has the names of its page";
  page.show.obey(R"({"do":"load","name":"humanoid"})");
  page.show.obey(R"({"do":"compare","name":"mass against equal"})");
  EXPECT_TRUE(says("all at once.\"") && says(R"("hint":"")")) << "there is no end mass to move";
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
