// How contact is added up and listed: sums by pairs, names of shapes and ground, phases, and their file.

#include "scenes/files/contacts.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "contact/ground/ground_numbers.hpp"
#include "contact/pulls/contact_list.hpp"
#include "contact/pulls/touched_pairs.hpp"
#include "plumb/joints.hpp"
#include "support/random_trees.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using detail::ContactList;
using detail::TouchedPair;
using detail::TouchedPairs;

TEST(TouchedPairs, TakeInNothingUnlessTheyCount) {
  TouchedPairs pairs;
  pairs.add(0, 1, 2, {.impulse = {1, 0, 0}});
  pairs.merge();
  EXPECT_TRUE(pairs.pairs().empty());
}

// The square of an impulse below 1e-162 N s is zero, so that it weighs nothing and has no mean place.
TEST(TouchedPairs, LeaveOutWhatWeighsNothing) {
  TouchedPairs pairs;
  pairs.counts = true;
  pairs.add(3, TouchedPair::ground, 7, {{0, 1e-170, 0}, {1, 0, 0}, {0, 1, 0}, 2});
  pairs.merge();
  EXPECT_TRUE(pairs.pairs().empty());
  pairs.add(3, TouchedPair::ground, 7, {{0, 1e-150, 0}, {1, 0, 0}, {0, 1, 0}, 2});
  pairs.merge();
  ASSERT_EQ(pairs.pairs().size(), 1u);
  EXPECT_GT(pairs.pairs()[0].weight, 0);
}

// Points of a pair are weighted by their impulses, and the fastest counts.
TEST(TouchedPairs, AddUpPoints) {
  TouchedPairs pairs;
  pairs.counts = true;
  pairs.add(3, TouchedPair::ground, 7, {{0, 3, 0}, {1, 0, 0}, {0, 1, 0}, 2});
  pairs.add(2, 5, 1, {{4, 0, 0}, {0, 0, 9}, {1, 0, 0}, 0});
  pairs.add(3, TouchedPair::ground, 7, {{0, 1, 0}, {5, 0, 0}, {0, 1, 0}, 1});
  pairs.add(3, TouchedPair::ground, 7, {{0, 0, 0}, {9, 9, 9}, {0, 1, 0}, 8});
  pairs.add(3, TouchedPair::ground, 7, {{0, NAN, 0}, {9, 9, 9}, {0, 1, 0}, 8});
  pairs.merge();
  ASSERT_EQ(pairs.pairs().size(), 2u);
  EXPECT_EQ(pairs.pairs()[0].shape, 2u);
  const TouchedPair& sum = pairs.pairs()[1];
  EXPECT_EQ(sum.impulse, (Vec3{0, 4, 0}));
  EXPECT_EQ(sum.weight, 4);
  EXPECT_EQ(sum.place, (Vec3{8, 0, 0}));
  EXPECT_EQ(sum.approach, 2);
  pairs.begin_step();
  EXPECT_TRUE(pairs.pairs().empty());
}

// However often they are merged on the way, sums have the same bits: those of adding up in order.
TEST(TouchedPairs, HaveTheSameBitsWheneverTheyAreMerged) {
  TouchedPairs seldom, often;
  seldom.counts = often.counts = true;
  test::Random random(5);
  std::vector<Vec3> sums(10);
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const std::uint32_t shape = (7 * i + i / 13) % 10;
    const Vec3 impulse = test::random_vector(random);
    sums[shape] += impulse;
    for (TouchedPairs* const each : {&seldom, &often}) each->add(shape, 1, 2, {impulse, impulse, impulse, 0});
    if (i % 17 == 0) often.merge();
  }
  seldom.merge();
  often.merge();
  ASSERT_EQ(seldom.pairs().size(), 10u);
  for (std::uint32_t k = 0; k < 10; ++k) {
    EXPECT_EQ(seldom.pairs()[k].impulse, sums[k]);
    EXPECT_EQ(often.pairs()[k].impulse, sums[k]);
    EXPECT_EQ(often.pairs()[k].place, seldom.pairs()[k].place);
  }
}

TouchedPair pair_of(Vec3 impulse) {
  TouchedPair out;
  out.add({impulse, {1, 2, 3}, {0, 1, 0}, 0.5});
  return out;
}
std::string phases_of(const ContactList& list) {
  std::string out;
  for (const Contact& each : list.all())
    out += std::to_string(each.a.number) + std::to_string(each.b.number) +
           std::string(to_string(each.phase)) + " ";
  return out;
}

TEST(ContactList, SaysWhatBeganAndEnded) {
  ContactList list;
  const ShapeId one{ShapeKind::capsule, 1}, two{ShapeKind::capsule, 2}, floor{ShapeKind::plane, 0};
  const auto step = [&](std::vector<std::pair<ShapeId, ShapeId>> pairs) {
    list.begin();
    for (const auto& [shape, other] : pairs) list.add(shape, other, pair_of({0, 2, 0}));
    list.end();
    return phases_of(list);
  };
  EXPECT_EQ(step({{two, floor}, {two, one}}), "12began 20began ");
  EXPECT_EQ(list.all()[0].impulse, (Vec3{0, -2, 0})) << "on the first of them";
  EXPECT_EQ(list.all()[0].normal, (Vec3{0, -1, 0}));
  EXPECT_EQ(list.all()[1].impulse, (Vec3{0, 2, 0}));
  EXPECT_EQ(list.all()[1].point, (Vec3{1, 2, 3}));
  EXPECT_EQ(step({{one, floor}, {two, floor}, {two, floor}}), "12ended 10began 20persisted ");
  EXPECT_EQ(list.all()[0].impulse, Vec3{});
  EXPECT_EQ(list.all()[0].point, (Vec3{1, 2, 3})) << "where they touched last";
  EXPECT_EQ(list.all()[2].impulse, (Vec3{0, 4, 0})) << "what two islands saw of it";
  EXPECT_FALSE(list.is_steady());
  EXPECT_EQ(step({{one, floor}, {two, floor}}), "10persisted 20persisted ");
  EXPECT_TRUE(list.is_steady());
  EXPECT_EQ(step({}), "10ended 20ended ");
  EXPECT_EQ(step({}), "");
}

TEST(GroundNumbers, NameAllGround) {
  Scene scene;
  scene.particles = {{.position = {}, .fixed = true}, {.position = {1, 0, 0}, .mass = 1}};
  for (const std::uint32_t i : {1u, 0u, 1u, 0u})
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i)});
  scene.planes.resize(2);
  scene.boxes.resize(3);
  scene.ground_hulls.resize(1);
  scene.height_fields.resize(2);
  const detail::GroundNumbers numbers(scene);
  EXPECT_EQ(numbers.count(), 10u);
  EXPECT_EQ(numbers.id(numbers.of_plane(1)), (ShapeId{ShapeKind::plane, 1}));
  EXPECT_EQ(numbers.id(numbers.of_box(2)), (ShapeId{ShapeKind::box, 2}));
  EXPECT_EQ(numbers.id(numbers.of_anchored(1)), (ShapeId{ShapeKind::capsule, 3}));
  EXPECT_EQ(numbers.id(numbers.of_other(0)), (ShapeId{ShapeKind::ground_hull, 0}));
  EXPECT_EQ(numbers.id(numbers.of_other(2)), (ShapeId{ShapeKind::height_field, 1}));
  for (const ShapeId id : {ShapeId{ShapeKind::plane, 1}, ShapeId{ShapeKind::box, 2},
                           ShapeId{ShapeKind::ground_hull, 0}, ShapeId{ShapeKind::height_field, 1}})
    EXPECT_EQ(numbers.id(numbers.of(id)), id);
}

TEST(ContactFiles, HaveOneRowForEachPair) {
  std::string csv(scenes::contacts_header);
  const Contact contact{{ShapeKind::capsule, 3},
                        {ShapeKind::height_field, 0},
                        ContactPhase::began,
                        {1, 2, 3},
                        {0, 1, 0},
                        {0, 0.5, 0},
                        4};
  scenes::append_contacts(csv, 0.25, {&contact, 1});
  EXPECT_EQ(csv,
            "t,a,b,phase,x,y,z,nx,ny,nz,ix,iy,iz,speed\n"
            "0.25,capsule 3,height_field 0,began,1,2,3,0,1,0,0,0.5,0,4\n");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
