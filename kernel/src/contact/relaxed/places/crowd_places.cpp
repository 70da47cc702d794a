#include "contact/relaxed/places/crowd_places.hpp"

#include <algorithm>

namespace plumb::detail {

void CrowdPlaces::lay_out(std::span<LinkageState* const> cluster, std::span<const std::uint8_t> moves,
                          std::uint32_t lanes) {
  lanes_ = lanes;
  rows_ = std::all_of(cluster.begin(), cluster.end(),
                      [&](const LinkageState* state) { return fills_rows(state->linkage->colored().grid); });
  first_.clear();
  begin_.assign(1, 0);
  at_.clear();
  rods_.clear();
  colors_.clear();
  address_a_.clear();
  address_b_.clear();
  count_ = 0;
  if (rows_)
    place_rows(cluster);
  else
    place_records(cluster);
  numbers_ = begin_.back();
  particle_at_.assign(padded_numbers(), none);
  for (std::uint32_t k = 0; k < at_.size(); ++k) particle_at_[at_[k]] = k;
  if (rows_)
    add_rows(cluster, moves);
  else
    add_records(cluster, moves);
}

/// Returns whether a net in strips leaves few lanes empty. Rows of one strip alone would be neighbours of
/// each other in the next. Ropes stay records: sweeps of rows would take a quarter off their time, but in
/// that order a coil that method direct relaxes at times gained energy.
bool CrowdPlaces::fills_rows(const Grid& grid) const {
  const std::uint32_t rows = rows_of(grid);
  return rows > 1 && 4 * grid.height >= 3 * rows * lanes_;
}

void CrowdPlaces::place_records(std::span<LinkageState* const> cluster) {
  for (const LinkageState* const state : cluster) {
    first_.push_back(particles());
    for (std::uint32_t k = 0; k < state->linkage->particles(); ++k) at_.push_back(record * particles());
    begin_.push_back(record * particles());
  }
}

void CrowdPlaces::place_rows(std::span<LinkageState* const> cluster) {
  for (const LinkageState* const state : cluster) {
    const Grid& grid = state->linkage->colored().grid;
    const std::uint32_t rows = rows_of(grid), begin = begin_.back();
    first_.push_back(particles());
    at_.resize(at_.size() + grid.particles.size());
    for (std::uint32_t y = 0; y < grid.height; ++y)
      for (std::uint32_t x = 0; x < grid.width; ++x)
        at_[first_.back() + grid.particles[y * grid.width + x]] =
            begin + (x * rows + y % rows) * pitch() + y / rows;
    begin_.push_back(begin + grid.width * rows * pitch());
  }
}

void CrowdPlaces::end_color(std::uint32_t begin) {
  const auto end = static_cast<std::uint32_t>(rods_.size() / lanes_);
  if (begin != end) colors_.push_back({begin, end});
}

void CrowdPlaces::add_records(std::span<LinkageState* const> cluster, std::span<const std::uint8_t> moves) {
  std::uint32_t most = 0;
  for (const LinkageState* const state : cluster) most = std::max(most, state->linkage->colored().colors());
  for (std::uint32_t color = 0; color < most; ++color) {
    const auto begin = static_cast<std::uint32_t>(rods_.size() / lanes_);
    for (std::uint32_t i = 0; i < cluster.size(); ++i) {
      if (moves[i] == 0) continue;
      for (const ColoredRods::Rod& rod : cluster[i]->linkage->colored().of(color)) {
        rods_.push_back({i, rod.number, first_[i] + rod.a, first_[i] + rod.b, rod.length2});
        address_a_.push_back(at_[rods_.back().a]);
        address_b_.push_back(at_[rods_.back().b]);
        ++count_;
      }
    }
    // Padding lanes have both ends behind the last particle.
    while (rods_.size() % lanes_ != 0) {
      rods_.push_back({});
      address_a_.push_back(numbers_);
      address_b_.push_back(numbers_);
    }
    end_color(begin);
  }
}

void CrowdPlaces::add_rows(std::span<LinkageState* const> cluster, std::span<const std::uint8_t> moves) {
  for (const Kind kind : kinds) {
    const auto begin = static_cast<std::uint32_t>(rods_.size() / lanes_);
    for (std::uint32_t i = 0; i < cluster.size(); ++i)
      if (moves[i] != 0) add_rows(i, cluster[i]->linkage->colored().grid, kind);
    end_color(begin);
  }
}

/// Adds a vector of rods from the row at `a` to that at `b`. Calls rod_of(lane) for each, which is null for
/// padding.
template <class RodOf>
void CrowdPlaces::add_vector(std::uint32_t island, std::uint32_t a, std::uint32_t b, RodOf&& rod_of) {
  address_a_.push_back(a);
  address_b_.push_back(b);
  for (std::uint32_t lane = 0; lane < lanes_; ++lane) {
    const ColoredRods::Rod* const rod = rod_of(lane);
    if (rod == nullptr) {
      rods_.push_back({});
      continue;
    }
    rods_.push_back({island, rod->number, particle_at_[a + lane], particle_at_[b + lane], rod->length2});
    ++count_;
  }
}

/// Adds the rods of a kind: between rows of all strips, from the last row of each to the first of the next
/// one (the seam), and between columns.
void CrowdPlaces::add_rows(std::uint32_t island, const Grid& grid, Kind kind) {
  const std::uint32_t width = grid.width, height = grid.height, rows = rows_of(grid);
  const auto row_at = [&](std::uint32_t x, std::uint32_t row) {
    return begin_[island] + (x * rows + row) * pitch();
  };
  if (kind == Kind::even_across || kind == Kind::odd_across) {
    for (std::uint32_t x = kind == Kind::odd_across ? 1 : 0; x + 1 < width; x += 2)
      for (std::uint32_t row = 0; row < rows; ++row)
        add_vector(island, row_at(x, row), row_at(x + 1, row), [&](std::uint32_t lane) {
          const std::uint32_t y = lane * rows + row;
          return y < height ? &grid.rods[y * (width - 1) + x] : nullptr;
        });
    return;
  }
  const auto down = [&](std::uint32_t x, std::uint32_t row) {
    return [&grid, x, row, rows, width, height](std::uint32_t lane) {
      const std::uint32_t y = lane * rows + row;
      return y + 1 < height ? &grid.rods[height * (width - 1) + y * width + x] : nullptr;
    };
  };
  for (std::uint32_t x = 0; x < width; ++x) {
    if (kind == Kind::seam) add_vector(island, row_at(x, rows - 1), row_at(x, 0) + 1, down(x, rows - 1));
    if (kind == Kind::seam) continue;
    for (std::uint32_t row = kind == Kind::odd_down ? 1 : 0; row + 1 < rows; row += 2)
      add_vector(island, row_at(x, row), row_at(x, row + 1), down(x, row));
  }
}

}  // namespace plumb::detail
