#include "scenes/generators/generators.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include "plumb/error.hpp"
#include "plumb/inertia.hpp"
#include "plumb/joints.hpp"
#include "plumb/scene.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/shapeless.hpp"
#include "scenes/basics/start_strain.hpp"
#include "scenes/files/scene_file.hpp"
#include "scenes/generators/wires.hpp"
#include "scenes/spec.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

std::string message_of(std::string_view spec) {
  try {
    load_scene(spec);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// FNV-1a over the bits of everything in a scene.
std::uint64_t hash_of(const Scene& scene) {
  std::uint64_t hash = 14695981039346656037u;
  const auto add = [&](auto value) {
    unsigned char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
  };
  for (const Particle& p : scene.particles) {
    for (const double v : {p.position.x, p.position.y, p.position.z, p.mass}) add(v);
    add(p.fixed);
  }
  for (const Rod& r : scene.rods) {
    add(r.a);
    add(r.b);
    add(r.length);
  }
  return hash;
}

void expect_lengths_match_positions(const Scene& scene, double tolerance) {
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    const double distance = norm(scene.particles[rod.b].position - scene.particles[rod.a].position);
    EXPECT_NEAR(distance, rod_length(scene, i), tolerance) << "rod " << i;
  }
}

std::size_t count_fixed(const Scene& scene) {
  std::size_t n = 0;
  for (const Particle& p : scene.particles) n += p.fixed;
  return n;
}

TEST(Generators, ChainLiesAlongXFromAFixedParticle) {
  const Scene scene = make_chain(20, 0.1, 10);
  ASSERT_EQ(scene.particles.size(), 21u);
  ASSERT_EQ(scene.rods.size(), 20u);
  EXPECT_TRUE(scene.particles[0].fixed);
  EXPECT_EQ(scene.particles[0].position, Vec3{});
  for (std::uint32_t i = 1; i <= 20; ++i) {
    EXPECT_EQ(scene.particles[i].position, (Vec3{i * 0.1, 0, 0}));
    EXPECT_EQ(scene.particles[i].mass, i == 20 ? 10 : 1);
    EXPECT_FALSE(scene.particles[i].fixed);
    EXPECT_EQ(scene.rods[i - 1].a, i - 1);
    EXPECT_EQ(scene.rods[i - 1].b, i);
    EXPECT_EQ(scene.rods[i - 1].mass, 0);
  }
  // i·0.1 is rounded to the last bit of at most 2 m.
  expect_lengths_match_positions(scene, 4e-16);
}

TEST(Generators, ThesisChainHasFiveLinksAndADoubleEnd) {
  const Scene scene = make_thesis5();
  ASSERT_EQ(scene.rods.size(), 5u);
  EXPECT_EQ(scene.particles.back().mass, 2);
  EXPECT_EQ(hash_of(scene), hash_of(load_scene("chain:links=5,end_mass=2")));
}

TEST(Generators, NetHangsFromItsTwoUpperCorners) {
  const Scene scene = make_net(4, 3, 0.5);
  ASSERT_EQ(scene.particles.size(), 12u);
  EXPECT_EQ(scene.rods.size(), 3u * 3 + 4 * 2);
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    EXPECT_EQ(scene.particles[i].fixed, i == 0 || i == 3) << "particle " << i;
    EXPECT_EQ(scene.particles[i].position,
              (Vec3{0.5 * static_cast<double>(i % 4), -0.5 * static_cast<double>(i / 4), 0}));
  }
  expect_lengths_match_positions(scene, 1e-15);
}

TEST(Generators, EnsembleHoldsEqualChainsSideBySide) {
  const Scene scene = make_ensemble({.chains = 3, .links = 4, .end_mass = 10, .spacing = 0.25});
  ASSERT_EQ(scene.particles.size(), 15u);
  ASSERT_EQ(scene.rods.size(), 12u);
  EXPECT_EQ(count_fixed(scene), 3u);
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    const Particle& first = scene.particles[i % 5];
    const Particle& here = scene.particles[i];
    EXPECT_EQ(here.position, (Vec3{first.position.x, 0, 0.25 * static_cast<double>(i / 5)}));
    EXPECT_EQ(here.mass, first.mass);
  }
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    EXPECT_EQ(scene.rods[i].a / 5, i / 4);
    EXPECT_EQ(scene.rods[i].b, scene.rods[i].a + 1);
  }
}

TEST(Generators, EnsembleVariesOnlyWhenAsked) {
  const Scene same = make_ensemble({.chains = 10, .links = 2});
  const Scene other_seed = make_ensemble({.chains = 10, .links = 2, .seed = 2});
  EXPECT_EQ(hash_of(same), hash_of(other_seed));
  const Scene varied = make_ensemble({.chains = 10, .links = 2, .end_mass = 10, .vary = 0.5});
  EXPECT_NE(varied.particles[2].mass, varied.particles[5].mass);
  for (std::size_t i = 2; i < varied.particles.size(); i += 3) {
    EXPECT_GE(varied.particles[i].mass, 5);
    EXPECT_LE(varied.particles[i].mass, 15);
  }
}

TEST(Generators, RingHangsFromItsHighestParticle) {
  const Scene scene = make_ring({.links = 6, .length = 0.5});
  ASSERT_EQ(scene.particles.size(), 6u);
  ASSERT_EQ(scene.rods.size(), 6u);
  EXPECT_EQ(count_fixed(scene), 1u);
  EXPECT_TRUE(scene.particles[0].fixed);
  EXPECT_EQ(scene.particles[0].position, Vec3{});
  EXPECT_NEAR(scene.particles[3].position.y, -1, 1e-15);  // a hexagon is as high as two of its sides
  expect_lengths_match_positions(scene, 1e-15);
}

// A rigid body of n particles of which three are fixed needs 3 (n - 3) rods, and so has the triangular truss.
TEST(Generators, TrussHasAsManyRodsAsItNeedsOrMore) {
  const Scene scene = make_truss({.bays = 4});
  ASSERT_EQ(scene.particles.size(), 15u);
  EXPECT_EQ(count_fixed(scene), 3u);
  EXPECT_EQ(scene.rods.size(), 3u * 12);
  EXPECT_EQ(make_truss({.bays = 4, .braces = 2}).rods.size(), 3u * 12 + 3u * 4);
  EXPECT_EQ(make_truss({.bays = 4, .chords = 2}).rods.size(), 2u * 8);  // in its plane
  EXPECT_EQ(count_fixed(make_truss({.bays = 4, .fixed = 2})), 2u);
  for (const std::uint32_t chords : {2u, 3u})
    for (const std::uint32_t fixed : {1u, 2u})
      EXPECT_NO_THROW(validate(make_truss({.bays = 4, .chords = chords, .braces = 2, .fixed = fixed})));
}

TEST(Generators, GraphHasTheDegreeAskedForAndIsNearlyConnected) {
  const Scene scene = make_graph({});
  ASSERT_EQ(scene.particles.size(), 1000u);
  EXPECT_EQ(scene.rods.size(), 2000u);  // degree 4: two rods to a particle
  EXPECT_EQ(count_fixed(scene), 21u);
  expect_lengths_match_positions(scene, 0);
  EXPECT_NO_THROW(validate(scene));
  std::vector<std::uint32_t> parent(scene.particles.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i];
    return i;
  };
  for (const Rod& rod : scene.rods) parent[root(rod.a)] = root(rod.b);
  std::size_t components = 0;
  for (std::uint32_t i = 0; i < parent.size(); ++i) components += parent[i] == i;
  EXPECT_LE(components, 5u);
  for (const Particle& p : scene.particles) {
    if (p.fixed) continue;
    EXPECT_GE(p.mass, 0.5);
    EXPECT_LT(p.mass, 2);
  }
}

// The value was computed once and is the same with g++ 12 and clang 14: the standard fixes mt19937_64, and
// the rest is +, −, ×, ÷ and √.
TEST(Generators, GraphIsTheSameWithEveryCompiler) {
  EXPECT_EQ(hash_of(make_graph({.particles = 200})), 11851122842508265560u);
  EXPECT_NE(hash_of(make_graph({.particles = 200, .seed = 2})), hash_of(make_graph({.particles = 200})));
}

// A clamped end has no beam on its other side, so that its bend is twice as stiff.
TEST(Generators, AWireHasTheStiffnessOfItsMaterial) {
  const Scene scene = make_wire({.rods = 4, .length = 2, .mass = 8, .bending = 3, .torsion = 5, .twist = 7});
  ASSERT_EQ(scene.bends.size(), 4u);
  EXPECT_EQ(scene.bends[0].stiffness, 12);
  EXPECT_EQ(scene.bends[3].stiffness, 6);
  EXPECT_EQ(scene.particles.back().mass, 1);
  ASSERT_EQ(scene.twists.size(), 1u);
  EXPECT_EQ(scene.twists[0].particles.size(), 6u);
  EXPECT_EQ(scene.twists[0].stiffness, 5);
  EXPECT_EQ(scene.twists[0].angle, 7);
  EXPECT_TRUE(make_wire({.torsion = 0}).twists.empty());
  EXPECT_EQ(message_of("wire:bending=0"), "scene 'wire:bending=0': bending must be positive and finite");
}

TEST(Generators, EveryListedDefaultCanBeWrittenOut) {
  ASSERT_GE(list_generators().size(), 5u);
  for (const GeneratorHelp& help : list_generators()) {
    const std::string spec = help.parameters.empty() ? help.name : help.name + ":" + help.parameters;
    EXPECT_EQ(hash_of(load_scene(spec)), hash_of(load_scene(help.name))) << spec;
  }
}

// What touches has shapes. Three links of this chain have none, and its body has one on two of its particles.
TEST(Generators, CountWhatHasNoShape) {
  Scene scene = make_chain(3);
  EXPECT_FALSE(has_ground(scene));
  EXPECT_EQ(count_shapeless(scene), 3u) << "anchors do not count";
  scene.planes.push_back({});
  EXPECT_TRUE(has_ground(scene));
  const std::uint32_t body = add_body(scene, solid_box(1, {1, 2, 3}));
  EXPECT_EQ(count_shapeless(scene), 7u);
  scene.capsules.push_back({.a = point_at(4), .b = point_at(5), .radius = 0.1});
  EXPECT_EQ(count_shapeless(scene), 3u);
  scene.capsules.clear();
  scene.hulls.push_back(box_on_body(body, {.half_size = {0.5, 1, 1.5}}));
  EXPECT_EQ(count_shapeless(scene), 3u);
}

// Of rods that keep their length, the one farthest off is told; cables may be slack.
TEST(Generators, TellWhatStartsOffItsLength) {
  Scene scene = make_chain(3);
  EXPECT_NEAR(start_strain(scene).strain, 0, 1e-15);
  const double distance = rod_length(scene, 1);
  scene.rods[1].length = 2 * distance;
  scene.rods[2].length = 0.8 * distance;
  EXPECT_EQ(start_strain(scene).rod, 1u);
  EXPECT_NEAR(start_strain(scene).strain, -0.5, 1e-15);
  scene.rods[1].law.one_sided = true;
  EXPECT_EQ(start_strain(scene).rod, 2u);
  EXPECT_NEAR(start_strain(scene).strain, 0.25, 1e-15);
}

TEST(Generators, WhatIsWrongInASpecIsNamed) {
  EXPECT_EQ(message_of("string"),
            "no scene 'string': there is no such file, and the generators are chain, thesis5, line, winch, "
            "net, ensemble, "
            "ring, truss, rods5, tree, humanoid, graph, crowd, stick_box, drop, wire, rope, heap, drape, "
            "terrain, boxes, pile, shot. Did you mean ring?");
  EXPECT_EQ(message_of("chain:colour=3"),
            "scene 'chain:colour=3': no parameter 'colour'; known are links, length, mass, end_mass, and of "
            "all scenes stiffness, damping, strength, cables");
  EXPECT_TRUE(message_of("chain:link=3").ends_with("cables. Did you mean links?"));
  EXPECT_TRUE(message_of("net:stifness=3").ends_with("cables. Did you mean stiffness?"));
  EXPECT_EQ(message_of("thesis5:links=3"),
            "scene 'thesis5:links=3': no parameter 'links'; it takes none of its own, and of all scenes "
            "stiffness, damping, strength, cables");
  EXPECT_EQ(message_of("chain:links=2.5"),
            "scene 'chain:links=2.5': links must be a whole number in digits, below 2^32, not '2.5'");
  EXPECT_EQ(message_of("chain:links=-1"),
            "scene 'chain:links=-1': links must be a whole number in digits, below 2^32, not '-1'");
  EXPECT_EQ(message_of("chain:length=nan"), "scene 'chain:length=nan': length must be a number, not 'nan'");
  EXPECT_EQ(message_of("chain:links=0"), "scene 'chain:links=0': links must be at least 1");
  EXPECT_EQ(message_of("chain:end_mass=0"), "scene 'chain:end_mass=0': end_mass must be positive and finite");
  EXPECT_EQ(message_of("chain:links"), "scene 'chain:links': expected key=value, found 'links'");
  EXPECT_EQ(message_of("chain:"), "scene 'chain:': expected key=value, found ''");
  EXPECT_EQ(message_of("chain:links=2,links=3"), "scene 'chain:links=2,links=3': links is given twice");
  EXPECT_EQ(message_of("ring:links=2"), "scene 'ring:links=2': links must be at least 3");
  EXPECT_EQ(message_of("truss:chords=4"), "scene 'truss:chords=4': chords must be 2 or 3");
  EXPECT_EQ(message_of("truss:braces=0"), "scene 'truss:braces=0': braces must be 1 or 2");
  EXPECT_EQ(message_of("net:width=2"), "scene 'net:width=2': width must be at least 3");
}

// The files beside the generators are what `plumb info SPEC --write FILE` makes of these.
TEST(Generators, SceneFilesEqualTheirGenerators) {
  const std::vector<std::pair<const char*, const char*>> files = {
      {"chain.json", "chain:links=20,end_mass=10"}, {"thesis5.json", "thesis5"},
      {"net.json", "net:width=8,height=8"},         {"ensemble.json", "ensemble:chains=8,links=8"},
      {"graph.json", "graph:particles=100"},
  };
  for (const auto& [file, spec] : files) {
    const std::string path = std::string(PLUMB_SCENES_DIR) + "/" + file;
    EXPECT_EQ(read_file(path), format_scene(load_scene(spec))) << path;
    EXPECT_EQ(hash_of(load_scene(path)), hash_of(load_scene(spec))) << path;
  }
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
