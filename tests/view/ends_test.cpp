// Every slider of the page at both of its ends, in every kind of scene, while a hand pulls.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "plumb/error.hpp"
#include "view/exhibits.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

using Ends = std::array<const char*, 3>;

/// The ends of sliders, as page/panel.js has them, and a value between.
const std::array<std::pair<const char*, Ends>, 7> sliders{{{"end_mass", {"0.1", "1000", "1"}},
                                                           {"gravity", {"0", "20", "9.81"}},
                                                           {"drag", {"5", "0", "0.1"}},
                                                           {"substeps", {"1", "128", "4"}},
                                                           {"sweeps", {"1", "1000", "10"}},
                                                           {"tolerance", {"0.1", "1e-8", "off"}},
                                                           {"accuracy", {"0.1", "1e-6", "off"}}}};

class ViewEnds : public testing::TestWithParam<const char*> {};

TEST_P(ViewEnds, OfSlidersAreTakenOrRefusedInWords) {
  // Relaxation moves no bends.
  const bool bends = std::string_view(GetParam()).starts_with("wire");
  Exhibit exhibit(
      test::start_of(GetParam(), {{.substeps = 2}, {.method = bends ? Method::direct : Method::relax}}));
  try {
    exhibit.take({.verb = Verb::pull, .number = 1, .at = {0.5, 0.5, 0}});
  } catch (const InputError&) {
    // What has no grip is moved by sliders alone.
  }
  for (const auto& [name, ends] : sliders)
    for (const char* end : ends) {
      try {
        exhibit.take(test::set(name, end));
      } catch (const InputError& error) {
        EXPECT_GT(std::string(error.what()).size(), 10U) << name << " = " << end;
      }
      test::run(exhibit, 2);
      EXPECT_TRUE(test::is_sound(exhibit)) << name << " = " << end;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ViewEnds,
                         testing::Values("chain:links=8", "line:links=8", "winch:rods=6",
                                         "net:width=5,height=5", "ensemble:chains=5,links=4", "ring:links=8",
                                         "truss:bays=3", "rods5", "tree", "humanoid", "humanoid:body=medium",
                                         "graph:particles=40", "crowd:humanoids=4,hit=2", "stick_box", "drop",
                                         "wire:rods=8", "rope:links=8", "heap:ropes=4,links=6",
                                         "drape:size=6", "boxes:boxes=2", "pile:figures=2"));

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
