// The list of large things that grows without moving them.

#include "contact/chunks.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

struct Thing {
  int number = -1;
};

TEST(Chunks, KeepsThingsInPlaceAndInOrder) {
  Chunks<Thing> chunks;
  EXPECT_TRUE(chunks.empty());
  std::vector<const Thing*> places;
  for (int i = 0; i < 100; ++i) {
    Thing& thing = chunks.add();
    thing.number = i;
    places.push_back(&thing);
  }
  EXPECT_EQ(chunks.size(), 100u);
  std::size_t count = 0;
  for (const Thing& each : chunks) {
    EXPECT_EQ(&each, places[count]);
    EXPECT_EQ(each.number, static_cast<int>(count));
    ++count;
  }
  EXPECT_EQ(count, 100u);
}

TEST(Chunks, UsesRoomAgainAndForgetsWhatWasThere) {
  Chunks<Thing> chunks;
  const Thing* const first = &(chunks.add() = {7});
  chunks.clear();
  EXPECT_TRUE(chunks.empty());
  EXPECT_FALSE(chunks.begin() != chunks.end());
  EXPECT_EQ(&chunks.add(), first);
  EXPECT_EQ(first->number, -1);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
