#pragma once

#include <cstdint>
#include <span>

#include "contact/linkage/linkage_state.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/layouts/packing.hpp"

namespace plumb::detail {

/// Says where the particles of a crowd lie among its numbers, and which rods lie in which lanes.
///
/// Where all islands are nets that fill lanes well, each is cut into as many strips of rows as there are
/// lanes. Neighbouring numbers are then x of one row in each strip, and the rods of a vector join two such
/// rows. Elsewhere a particle is a record of four numbers, the last of which is unused, and rods have two
/// addresses each.
class CrowdPlaces {
 public:
  static constexpr std::uint32_t none = 0xffffffff;
  struct Rod {
    std::uint32_t island = none, number = 0;
    std::uint32_t a = 0, b = 0;  ///< particles of the crowd
    double length2 = 0;          ///< m²
  };
  /// Vectors [begin, end) hold rods of one colour, which share no movable particle.
  struct Vectors {
    std::uint32_t begin, end;
  };

  /// Lays out the islands of a cluster; rods of those that do not move are left out.
  void lay_out(std::span<LinkageState* const> cluster, std::span<const std::uint8_t> moves,
               std::uint32_t lanes);

  layouts::Access access() const { return rows_ ? layouts::Access::rows : layouts::Access::records; }
  /// Counts numbers from x to y, and from y to z, of a particle.
  std::uint32_t component_stride() const { return rows_ ? lanes_ : 1; }
  /// Counts numbers from the x of as many particles as the stride to those of the next ones.
  std::uint32_t pitch() const { return rows_ ? 3 * lanes_ : record; }
  /// Counts numbers of all particles. Behind them are those of padding.
  std::uint32_t numbers() const { return numbers_; }
  std::uint32_t padded_numbers() const { return numbers_ + pitch(); }

  std::uint32_t particles() const { return static_cast<std::uint32_t>(at_.size()); }
  /// Returns the crowd's number of an island's first particle, and the range of an island's numbers.
  std::uint32_t first(std::uint32_t island) const { return first_[island]; }
  std::uint32_t begin_of(std::uint32_t island) const { return begin_[island]; }
  std::uint32_t end_of(std::uint32_t island) const { return begin_[island + 1]; }
  /// Returns the number that is a particle's x, and whose x a number is.
  std::uint32_t at(std::uint32_t particle) const { return at_[particle]; }
  std::uint32_t particle_at(std::uint32_t number) const { return particle_at_[number]; }

  std::span<const Rod> rods() const { return rods_; }  ///< by lane
  std::uint32_t count_rods() const { return count_; }
  std::span<const Vectors> colors() const { return colors_; }
  /// @{
  /// The x of ends of rods: of a vector's first with rows, else of each.
  const std::uint32_t* address_a() const { return address_a_.data(); }
  const std::uint32_t* address_b() const { return address_b_.data(); }
  /// @}

 private:
  using Grid = ColoredRods::Grid;
  static constexpr std::uint32_t record = 4;
  /// Names rods of a grid that join rows of its strips.
  enum class Kind : std::uint8_t { even_down, odd_down, seam, even_across, odd_across };
  static constexpr Kind kinds[] = {Kind::even_down, Kind::odd_down, Kind::seam, Kind::even_across,
                                   Kind::odd_across};

  bool fills_rows(const Grid& grid) const;
  std::uint32_t rows_of(const Grid& grid) const { return (grid.height + lanes_ - 1) / lanes_; }
  void place_records(std::span<LinkageState* const> cluster);
  void place_rows(std::span<LinkageState* const> cluster);
  void add_records(std::span<LinkageState* const> cluster, std::span<const std::uint8_t> moves);
  void add_rows(std::span<LinkageState* const> cluster, std::span<const std::uint8_t> moves);
  void add_rows(std::uint32_t island, const Grid& grid, Kind kind);
  template <class RodOf>
  void add_vector(std::uint32_t island, std::uint32_t a, std::uint32_t b, RodOf&& rod_of);
  void end_color(std::uint32_t begin);

  std::uint32_t lanes_ = 0, numbers_ = 0, count_ = 0;
  bool rows_ = false;
  Array<std::uint32_t> first_, begin_;  ///< by island
  Array<std::uint32_t> at_;             ///< by particle
  Array<std::uint32_t> particle_at_;    ///< by number
  Array<Rod> rods_;
  Array<Vectors> colors_;
  Array<std::uint32_t> address_a_, address_b_;
};

}  // namespace plumb::detail
