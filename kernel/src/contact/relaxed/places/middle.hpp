#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contact/relaxed/crowd.hpp"

namespace plumb::detail {

/// This is a place on the middle of a shape, as a sum of the crowd's particles. It is made for every contact
/// of every substep, so that what it does not need is not even set.
template <class T>
class Middle {
 public:
  using Term = typename Crowd<T>::Term;

  /// Takes a sum of an island's particles.
  Middle(const Crowd<T>& crowd, const Linkage& linkage, std::uint32_t island, Terms sum) {
    for (const auto& term : sum) terms_[count_++] = crowd.term(linkage, island, term);
  }
  /// Takes the place between two particles that differ, at `t` from 0 to 1, as blend() does.
  Middle(const Term& a, const Term& b, double t) {
    if (t < 1) terms_[count_++] = t <= 0 ? a : scaled(a, 1 - t);
    if (t > 0) terms_[count_++] = t >= 1 ? b : scaled(b, t);
  }
  Middle(const Middle&) = delete;
  Middle& operator=(const Middle&) = delete;

  std::span<const Term> terms() const { return {terms_.data(), count_}; }

 private:
  static Term scaled(const Term& term, double by) { return {term.at, by * term.weight, by * term.move}; }

  std::array<Term, std::tuple_size_v<decltype(Combination::terms)>> terms_;
  std::uint32_t count_ = 0;
};

}  // namespace plumb::detail
