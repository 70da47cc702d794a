// Contacts of a crowd in vectors of lanes: who is visited with whom, and what that does to momentum.

#include "contact/relaxed/visits/contact_vectors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "contact/pair_order.hpp"
#include "contact/relaxed/crowd.hpp"
#include "support/executors.hpp"
#include "support/graphs.hpp"
#include "threads/team.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::Random;

/// Particles of 1 to 2 kg, which nothing joins but a line of rods, and one that is fixed.
Scene line_of(std::uint32_t count) {
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < count; ++i) {
    scene.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = 1 + 0.01 * (i % 100)});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
  }
  scene.particles.push_back({.position = {-0.1, 0, 0}, .fixed = true});
  scene.rods.push_back({.a = count, .b = 0});
  return scene;
}

/// Contacts of random particles, several on each.
template <class T>
struct SomeContacts {
  static constexpr std::uint32_t count = 900;
  std::uint32_t particles;
  Scene scene;
  Linkage kind{scene, best_isa(), Linkage::Use::relaxed};
  LinkageState state{kind, 0, scene};
  std::vector<LinkageState*> cluster{&state};
  Crowd<T> crowd;
  ContactVectors<T> vectors{simd::kernels<T>(best_isa())};
  Array<Array<typename Crowd<T>::Term>> terms;
  std::vector<double> push = std::vector<double>(count);
  std::vector<Vec3> across = std::vector<Vec3>(count), normal;
  std::uint32_t in_vectors = 0;

  explicit SomeContacts(std::uint32_t of = 300) : particles(of), scene(line_of(of)) {
    Random random(5);
    crowd.gather(cluster, {});
    crowd.predict(0.01, Gradient::new_);
    vectors.begin(crowd);
    for (std::uint32_t i = 0; i < count; ++i) {
      Combination sum;
      const std::uint32_t size = 1 + i % 4;
      while (sum.count < size) {
        const auto particle = static_cast<std::uint32_t>(random() % particles);
        sum.add(particle, 1.0 / size);
      }
      terms.emplace_back();
      crowd.add_terms(kind, 0, sum, 1, terms.back());
      if (i % 50 == 0) terms.back().push_back({crowd.number_of(0, kind.movable()), 0.5, 0});
      const Vec3 up{test::signed_unit(random), 2, test::signed_unit(random)};
      normal.push_back((1 / norm(up)) * up);
      in_vectors += vectors.color(crowd, terms.back()) ? 1 : 0;
    }
    vectors.reserve(crowd);
    for (std::uint32_t i = 0; i < count; ++i) {
      double moves = 0;
      for (const auto& term : terms[i]) moves += term.weight * term.move;
      vectors.put(crowd,
                  {.terms = terms[i],
                   .normal = normal[i],
                   .gap = i % 3 == 0 ? -0.001 : 0.0005,
                   .over = 1 / moves,
                   .friction = 0.3},
                  {&push[i], &across[i]});
    }
    for (std::uint32_t k = 0; k < particles; ++k)
      crowd.push(crowd.number_of(0, k), {0.001 * test::signed_unit(random), -0.002, 0});
  }
  Vec3 momentum() const {
    Vec3 out;
    for (std::uint32_t k = 0; k < particles; ++k) out += kind.mass_of(k) * crowd.moved(crowd.number_of(0, k));
    return out;
  }
};

// If two lanes of a vector moved the same particle, one of both pushes would be lost.
TEST(ContactVectors, KeepMomentumWhereManyContactsMoveAParticle) {
  SomeContacts<double> some;
  ASSERT_EQ(some.in_vectors, some.count);
  const Vec3 before = some.momentum();
  for (int i = 0; i < 5; ++i) some.vectors.sweep(some.crowd, nullptr);
  some.vectors.write_back();
  Vec3 pushed;
  for (std::uint32_t i = 0; i < some.count; ++i) {
    EXPECT_GE(some.push[i], 0);
    const Vec3 by = some.push[i] * some.normal[i] + some.across[i];
    for (const auto& term : some.terms[i]) pushed += (term.move != 0 ? term.weight : 0) * by;
  }
  EXPECT_GT(norm(pushed), 0.1);
  // Some thousand sums of numbers of grams and metres.
  EXPECT_LT(norm(some.momentum() - before - pushed), 1e-13);
}

TEST(ContactVectors, HaveTheSameBitsWithATeam) {
  const auto swept = [](unsigned threads) {
    SomeContacts<double> some(4000);  // so that most contacts have the first color
    Team team(threads);
    test::ThreadExecutor executor(threads);
    double most = 0;
    team.lead(&executor, [&] {
      some.vectors.sweep(some.crowd, &team);
      most = some.vectors.measured_sweep(some.crowd, &team);
    });
    some.vectors.write_back();
    std::vector<double> out{most};
    for (std::uint32_t i = 0; i < some.count; ++i) out.push_back(some.push[i]);
    return out;
  };
  EXPECT_EQ(swept(1), swept(2));
}

// What does not fit is left to others: too many terms, nothing that moves, one particle twice or too often.
TEST(ContactVectors, LeaveOutWhatDoesNotFit) {
  SomeContacts<double> some;
  const auto place = [&](std::uint32_t k) { return some.crowd.number_of(0, k); };
  some.vectors.begin(some.crowd);
  Array<Crowd<double>::Term> terms;
  EXPECT_FALSE(some.vectors.color(some.crowd, terms));
  for (std::uint32_t k = 0; k < 5; ++k) terms.push_back({place(k), 0.2, 0.2});
  EXPECT_FALSE(some.vectors.color(some.crowd, terms));
  terms = {{place(0), 1, 1}, {place(0), -0.5, -0.5}};
  EXPECT_FALSE(some.vectors.color(some.crowd, terms));
  terms = {{place(0), 1, 1}, {place(1), -1, -1}};
  int fit = 0;
  while (fit < 100 && some.vectors.color(some.crowd, terms)) ++fit;
  EXPECT_EQ(fit, 64);
}

struct Named {
  std::uint32_t first, second;
  auto operator<=>(const Named&) const = default;
};

TEST(PairOrder, SortsAsStandardSortDoesAndDropsWhatComesTwice) {
  Random random(3);
  PairOrder<Named> order;
  for (const std::uint32_t count : {1u, 2u, 40u}) {
    Array<Named> pairs;
    for (std::uint32_t second = 0; second < count; ++second)
      for (int i = 0; i < 10; ++i) pairs.push_back({static_cast<std::uint32_t>(random() % count), second});
    Array<Named> wanted = pairs;
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    // Duplicates of one second number follow each other in their order of being found.
    std::stable_sort(pairs.begin(), pairs.end(), [](Named a, Named b) { return a.second < b.second; });
    order.sort(pairs, &Named::first, count);
    EXPECT_EQ(pairs, wanted);
  }
  Array<Named> none;
  order.sort(none, &Named::first, 0);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
