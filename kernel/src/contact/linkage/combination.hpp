#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// This is a weighted sum of particles, which have their island's numbers.
struct Combination {
  struct Term {
    std::uint32_t particle = 0;
    double weight = 0;
  };
  std::array<Term, 8> terms{};
  std::uint32_t count = 0;

  void add(std::uint32_t particle, double weight);
  Vec3 of(std::span<const Vec3> values) const {
    Vec3 sum{};
    for (std::uint32_t i = 0; i < count; ++i) sum += terms[i].weight * values[terms[i].particle];
    return sum;
  }
};

/// This views the terms of a sum, which must outlive it.
class Terms : public std::span<const Combination::Term> {
 public:
  using std::span<const Combination::Term>::span;
  Terms(const Combination& of) : span(of.terms.data(), of.count) {}
  operator Combination() const {
    Combination out;
    std::copy(begin(), end(), out.terms.begin());
    out.count = static_cast<std::uint32_t>(size());
    return out;
  }
  Vec3 of(std::span<const Vec3> values) const {
    Vec3 sum{};
    for (const auto& [particle, weight] : *this) sum += weight * values[particle];
    return sum;
  }
};

/// Holds the terms of many sums, which stay where they are until all are cleared. Most places have one or two
/// terms, where a Combination has room for eight.
class TermPool {
 public:
  void clear() { chunk_ = used_ = 0; }
  /// Keeps a copy of terms, of which there are no more than a Combination has.
  Terms keep(Terms terms) {
    if (used_ + terms.size() > in_chunk) {
      ++chunk_;
      used_ = 0;
    }
    if (chunk_ == chunks_.size()) chunks_.push_back(std::make_unique<Combination::Term[]>(in_chunk));
    Combination::Term* const out = chunks_[chunk_].get() + used_;
    std::copy(terms.begin(), terms.end(), out);
    used_ += terms.size();
    return {out, terms.size()};
  }

 private:
  static constexpr std::size_t in_chunk = 64;

  Array<std::unique_ptr<Combination::Term[]>> chunks_;
  std::size_t chunk_ = 0, used_ = 0;  ///< the chunk that is filled, and how far
};

/// Returns the sum that a place is, and that of the way from one place to another.
Combination combination(const Point& point);
Combination difference(const Point& to, const Point& from);

}  // namespace plumb::detail
