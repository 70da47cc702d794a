#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "interface/archive.hpp"
#include "interface/read_rows.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/layouts/packing.hpp"
#include "plumb/layouts/stores.hpp"
#include "plumb/settings.hpp"
#include "plumb/vec3.hpp"
#include "relax/constants.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "time/leftovers.hpp"

namespace plumb::detail {

/// A block is a set of rods solved together, with its numbers in the places that its packing gives them.
///
/// Between substeps `x` holds positions (m) and displacement(0) the displacement of the last substep (m).
/// With gradient mid that is its velocity times h. displacement(1) is the one before. A substep predicts into
/// displacement(1), relaxes it, and the two change places.
template <class T>
class Block {
 public:
  Block(layouts::Packing packing, bool jacobi);

  const layouts::Packing& packing() const { return packing_; }

  /// Says by what rods share a correction.
  struct Weighing {
    const Constants& constants;
    Weights weights;
    SweepOrder order;
    double omega;
  };
  /// Writes shares of a correction and squared lengths for every rod, and finds which ranges need none of
  /// them.
  void set_weights(const Weighing& by);

  /// Lets the rod in a lane be `length` (m) long at a step's start, and change that by `rate` (m/s) in it.
  void set_length(std::size_t lane, double length, double rate);
  double rate(std::size_t lane) const;  ///< m/s, with which it does so
  /// Makes the rods of positions [q0, q1) as long as they are `t` (s) after the step's start.
  void follow_lengths(std::uint32_t q0, std::uint32_t q1, double t);

  /// Lets rods keep something from now on, or no more. There is room for it.
  void begin_keeping() { kept_.resize(packing_.lane_edge.size()); }
  void end_keeping() { kept_.clear(); }
  bool is_keeping() const { return !kept_.empty(); }
  /// Lets rigid rods of a range do so. Ranges are no longer uniform then, until lengths are restored. Returns
  /// the largest |C|/L² that is kept.
  T keep_violations(simd::Range range, const Keeping<T>& by);
  void restore_lengths(simd::Range range, const Constants& constants);

  /// Lets rods see a slot with another inverse mass (1/kg) than its particle has, since something grabs it.
  /// set_weights() is due then.
  void add_grabbed(std::uint32_t slot, double inverse_mass);
  void remove_grabbed(std::uint32_t slot);
  /// Changes that of one which was added, and weighs its rods.
  void set_grabbed(std::uint32_t slot, double inverse_mass, const Weighing& by);
  double grabbed_inverse_mass(std::uint32_t slot) const;

  /// Returns the vectors of stage `stage` of position `q`.
  simd::Range range(std::uint32_t q, std::size_t stage) const {
    const std::uint32_t begin = q * packing_.position_vectors + packing_.stages[stage].begin;
    return {begin, begin + packing_.stages[stage].count, uniform_[q * packing_.stages.size() + stage] != 0};
  }
  /// Returns what kernels need to relax the displacements `p`. Corrections go to the accumulator if there is
  /// one (Jacobi).
  simd::BlockView<T> view(T* p);

  /// Says whether some rod gives. All rods of the block are then visited by the loops for such rods.
  bool gives() const { return gives_; }
  /// Returns what those loops need.
  simd::LawView<T> law_view(T* p, const simd::LawTerms<T>& terms);
  /// Gradient old keeps half of each rod's last pull, if rods give.
  layouts::AlignedBuffer<T>& half_kick() { return half_kick_; }

  /// Adds up from now on how rods pull.
  void count_pulls();
  /// Forgets the pulls of positions [q0, q1), as a step begins.
  void begin_pulls(std::uint32_t q0, std::uint32_t q1);
  /// Forgets what sweeps have moved the rods of a range by, as a substep begins.
  void begin_moves(simd::Range range);
  /// Adds the impulses of a substep in which sweeps moved these rods. A move (m) times `by` (1/s), over what
  /// its ends give (1/kg), is one.
  void count_moves(simd::Range range, double by);

  /// Says whether some rod may break.
  bool breaks() const { return !strengths_.empty(); }
  bool is_broken(std::size_t lane) const { return breaks() && broken_[lane] != 0; }
  /// Breaks the rods of a range whose mean pull over a substep of `h` (s) was more than they hold. They
  /// correct nothing from now on. `by` is that of count_moves(). Returns how many there are.
  std::uint32_t break_rods(simd::Range range, double by, double h);
  /// Holds what breaking changes.
  struct SavedRods {
    Array<T> weight, law;
    Array<double> mass_of_move;
    Array<std::uint8_t> broken;
  };
  void save_rods(SavedRods& to) const;
  void restore_rods(const SavedRods& from);

  /// Returns the impulses (N s) of rods' pulls in a step, by lane; none unless they count.
  Array<double>& pulls() { return pulls_; }
  const Array<double>& pulls() const { return pulls_; }

  T* x() { return x_.data(); }
  const T* x() const { return x_.data(); }
  T* displacement(unsigned ago) { return displacements_[(newest_ + ago) & 1].data(); }
  const T* displacement(unsigned ago) const { return displacements_[(newest_ + ago) & 1].data(); }
  T* kick() { return kick_.data(); }
  T* accumulator() { return accumulator_.data(); }
  /// Says that all positions were advanced by `n` substeps, each of which used displacement(0) and
  /// displacement(1) in turn as its last and its own.
  void count_substeps(std::uint32_t n) { newest_ ^= n & 1; }

  void write(T* field, std::uint32_t slot, Vec3 value) const;
  Vec3 read(const T* field, std::uint32_t slot) const { return reader(field)(packing_.slot_offset[slot]); }
  /// Returns what reads a field at the offset of a slot.
  auto reader(const T* field) const {
    return [store = layouts::StoreView<const T>{field, packing_.component_stride}](std::uint32_t at) -> Vec3 {
      return {store.x(at), store.y(at), store.z(at)};
    };
  }

  /// Reads a field at the addresses of a run, whose rows may be in lanes side by side.
  void read_run(const T* field, const Run& run, Vec3* out) const {
    if (run.rows > 1 && run.row_address != 1) return run.read_addresses(out, reader(field));
    read_rows(run,
              RowsAt<T>{field + run.address, static_cast<std::ptrdiff_t>(packing_.component_stride),
                        static_cast<std::int32_t>(run.address_stride)},
              out);
  }

  /// Lists which rods do not take part, and how long others have become. Returns whether set_weights() is due
  /// after that.
  bool archive_rods(Archive& archive) {
    const bool breaks = archive.changes(broken_), freezes = archive.changes(frozen_slots_);
    const bool had_changed = !changed_.empty();
    archive(changed_, changed_length2_);
    return breaks || freezes || (archive.restores() && (had_changed || !changed_.empty()));
  }
  /// Lists what else substeps leave to the next one. Weights and laws follow from rules and from which rods
  /// take part.
  void archive(Archive& archive) {
    auto& [packing, x, displacements, kick, accumulator, rod, weight, law, law_start, shift, half_kick, gives,
           moved, pulls, mass_of_move, strengths, square_bounds, broken, omega, newest, uniform,
           uniform_length2, uniform_share, uniform_rods, rods_before, moving_anchors, settling, frozen_slots,
           grabbed, changed, changed_length2, kept] = *this;
    archive(x, displacements[newest & 1], displacements[(newest + 1) & 1], kick, half_kick, pulls,
            moving_anchors, settling, kept);
  }

  std::uint32_t rods() const { return rods_before_.back(); }
  /// Counts the rods of positions [q0, q1), each once.
  std::uint32_t rods(std::uint32_t q0, std::uint32_t q1) const { return rods_before_[q1] - rods_before_[q0]; }
  std::uint32_t uniform_rods() const { return uniform_rods_; }
  std::size_t bytes() const;

  /// Lets a fixed slot move by `move` (m) every substep until anchors are released.
  void move_anchor(std::uint32_t slot, Vec3 move);
  /// Is called once all are set to move, so that those of a position are found without looking at all.
  void sort_moving_anchors();
  void release_anchors();
  /// Says whether velocities along rods may be left over from anchors that move or stopped a step ago, or
  /// from rods that started off their length.
  bool is_settling() const { return !moving_anchors_.empty() || settling_; }
  void settle() { settling_ = true; }
  /// Forgets the displacements in `field` of moving anchors in positions [q0, q1), which have no momentum.
  void rest_anchors(T* field, std::uint32_t q0, std::uint32_t q1) const;

  /// Puts islands with a non-finite displacement back to the start of the substep, at rest and without forces
  /// from now on. Returns how many there were. It allocates, and ends the program if it cannot. It looks only
  /// at slots with numbers in positions [q0, q1).
  std::uint32_t freeze_broken_islands(T* last, T* current, std::uint32_t q0, std::uint32_t q1) noexcept;
  /// Lets the island of a slot stand still for good, at no cost for its rods. Where positions are independent
  /// this looks at one of them alone.
  void freeze_island(std::uint32_t of);
  bool is_frozen(std::uint32_t slot) const { return frozen_slots_[slot] != 0; }
  /// Returns the position that a slot lies in, or 0 if positions depend on each other.
  std::uint32_t position_of(std::uint32_t slot) const {
    return packing_.coupling == layouts::Coupling::independent
               ? packing_.slot_offset[slot] / packing_.position_elements
               : 0;
  }

 private:
  /// A rod that changes its length, or has.
  struct ChangedRod {
    std::uint64_t lane;
    double length, rate;  ///< m at a step's start, and m/s in it
    void archive(Archive& archive) { archive(lane, length, rate); }
  };
  /// A slot that is grabbed, and its rods: their lanes, and the slots of their ends.
  struct Grabbed {
    struct Rod {
      std::size_t lane;
      std::uint32_t a, b;
    };
    std::uint32_t slot;
    double inverse_mass;
    Array<Rod> rods;
  };
  double inverse_mass_of(std::uint32_t slot, const Constants& constants) const;
  void weigh_grabbed(const Grabbed& of, const Weighing& by);
  void weigh_rod(std::size_t lane, std::uint32_t slot_a, std::uint32_t slot_b, const Weighing& by);
  std::size_t first_changed(std::size_t lane) const;
  double length2_of(std::size_t lane, const Constants& constants) const;
  void write_length(std::size_t lane, double length);
  /// Lets the range of a lane be visited with the weights of each rod.
  void tell_apart(std::size_t lane);
  bool is_within(std::uint32_t slot, std::uint32_t q0, std::uint32_t q1) const;
  /// Returns the first slot of positions [q0, q1), and the one after their last. Independent ones lie one
  /// after the other and have as many slots each. Others share all.
  std::pair<std::uint32_t, std::uint32_t> slots_in(std::uint32_t q0, std::uint32_t q1) const {
    const auto all = static_cast<std::uint32_t>(packing_.slot_offset.size());
    if (packing_.coupling != layouts::Coupling::independent) return {0, all};
    const std::uint32_t each = all / packing_.positions;
    return {q0 * each, q1 * each};
  }
  Array<std::uint32_t> slots_by_element() const;
  std::uint32_t element_of_end(const Array<std::uint32_t>& addresses, std::size_t lane) const;
  /// Turns the lanes of frozen islands' rods into padding, so that they are neither moved nor looked at
  /// again.
  void retire_frozen_rods(std::uint32_t q0, std::uint32_t q1);
  /// Turns a rod in a lane into padding, which pulls nothing.
  void switch_off(std::size_t lane);
  void forget_lengths_of_retired();
  void make_laws(const Constants& constants);
  void make_strengths(const Constants& constants);
  /// Tells may_break() of a rod's strength and mass.
  void set_bound(std::size_t lane);
  /// Returns whether a rod of a vector of rods may have pulled more than it holds. `square` is that of what
  /// makes moves (m) of accelerations (m/s²).
  bool may_break(std::size_t v, double square) const;
  /// Returns the impulse (N s) with which a rod has pulled in a substep, see count_moves().
  double impulse_of(std::size_t lane, double by) const;
  /// Writes how a rod gives whose ends give way by `give` (1/kg). Its shares are of `split` times that.
  void write_law(std::size_t lane, const RodLaw& law, double length, double give, double split);
  std::uint32_t distinct_rods(std::uint32_t begin, std::uint32_t end) const;
  void find_uniform_ranges(const std::map<std::pair<T, T>, std::uint32_t>& candidates);

  layouts::Packing packing_;
  layouts::AlignedBuffer<T> x_, displacements_[2], kick_, accumulator_, rod_, weight_;
  layouts::AlignedBuffer<T> law_, law_start_, shift_, half_kick_;  ///< Blocks of rigid rods have none.
  bool gives_ = false;
  layouts::AlignedBuffer<T> moved_;  ///< what counting sweeps have moved rigid rods by
  Array<double> pulls_;              ///< by lane, N s; none unless pulls count
  Array<double> mass_of_move_;       ///< by lane, kg; none unless pulls count or rods may break
  struct Strength {
    double strength;  ///< N
    bool counts;      ///< no lane before has the same rod
  };
  Array<Strength> strengths_;    ///< by lane; none if no rod may break
  Array<double> square_bounds_;  ///< likewise, (strength / mass of move)²
  Array<std::uint8_t> broken_;   ///< likewise
  T omega_ = 1;
  unsigned newest_ = 0;
  Array<std::uint8_t> uniform_;  ///< It has an entry per position and stage.
  T uniform_length2_ = 1, uniform_share_ = 0;
  std::uint32_t uniform_rods_ = 0;
  Array<std::uint32_t> rods_before_;     ///< It has positions + 1 entries.
  Array<std::uint32_t> moving_anchors_;  ///< These are slots, by their place in memory while stepping.
  bool settling_ = false;
  Array<std::uint8_t> frozen_slots_;
  Array<Grabbed> grabbed_;
  Array<ChangedRod> changed_;      ///< by lane
  Array<double> changed_length2_;  ///< by lane, m², or 0 for the others; none if no rod has changed
  Array<T> kept_;                  ///< by lane, m², see keep_violations(); none if nothing is kept
};

extern template class Block<float>;
extern template class Block<double>;

}  // namespace plumb::detail
