// This is the vector body of the loops over rods that give, which relax_lanes.hpp includes. It has internal
// linkage as that has. law_scalar.hpp says what is computed and why. The operations and their order are the
// same.

#pragma once

#include <limits>

#include "simd/relax/visit_lanes.hpp"

namespace plumb::simd {
namespace {

template <class T>
PLUMB_INLINE Batch<T> load_law(const LawView<T>& block, Position at, std::size_t field) {
  return load_field<law_fields::rod>(block.law, at, field);
}
template <class T>
PLUMB_INLINE Batch<T> load_start(const LawView<T>& block, Position at, std::size_t field) {
  return load_field<law_fields::start>(static_cast<const T*>(block.start), at, field);
}
template <class T>
PLUMB_INLINE T* shift_of(const LawView<T>& block, Position at) {
  return block.shift + at.v * law_fields::shift * logical_width<T> + at.first;
}
template <class T>
PLUMB_INLINE Triple<T> load_shift(const LawView<T>& block, Position at) {
  const T* from = shift_of(block, at);
  return {Batch<T>::load_aligned(from), Batch<T>::load_aligned(from + logical_width<T>),
          Batch<T>::load_aligned(from + 2 * logical_width<T>)};
}
template <class T>
PLUMB_INLINE void store_shift(const LawView<T>& block, Position at, const Triple<T>& shift) {
  T* to = shift_of(block, at);
  shift.x.store_aligned(to);
  shift.y.store_aligned(to + logical_width<T>);
  shift.z.store_aligned(to + 2 * logical_width<T>);
}
/// Returns `value` where `flag` is not 0, else `other`.
template <class T>
PLUMB_INLINE Batch<T> where(const Batch<T>& flag, const Batch<T>& value, const Batch<T>& other) {
  return lanes::select(flag != Batch<T>(T(0)), value, other);
}

template <class Access, class T>
void prepare_laws(const LawView<T>& block, Range range) {
  prepare<Access, T>(block, {range.begin, range.end, false});
  const Batch<T> zero(T(0)), half(T(0.5)), one(T(1));
  const LawTerms<T>& terms = block.terms;
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const Position at = position<T>(range.begin, i);
    const Triple<T> d2 = load_direction(static_cast<const T*>(block.rod), at);
    const Batch<T> length = half * lanes::sqrt(dot(d2, d2));
    const Batch<T> excess =
        load_field<rod_fields>(static_cast<const T*>(block.rod), at, 3) / (length + load_law(block, at, 0));
    const Batch<T> frequency2 = load_law(block, at, 1), split = load_law(block, at, 3);
    const Batch<T> rigid = load_law(block, at, 4), one_sided = load_law(block, at, 5);

    const Batch<T> fast = lanes::max(Batch<T>(terms.substep * terms.substep) * frequency2 - one, zero);
    const Batch<T> share = Batch<T>(terms.share) + half * (fast / (one + fast));
    const Batch<T> pull = Batch<T>(terms.kick) * frequency2;
    const Batch<T> damps = Batch<T>(terms.damping) * load_law(block, at, 2);
    const Batch<T> slope = pull * share + damps;
    const Batch<T> taut = where(one_sided, lanes::max(excess, zero), excess);
    const Batch<T> half_kick = load_field<1>(static_cast<const T*>(block.half_kick), at, 0);
    const Batch<T> before = (pull * (one - share) - damps) * taut + Batch<T>(terms.kick_before) * half_kick;
    const Batch<T> stiff = slope * split;

    T* start = block.start + at.v * law_fields::start * logical_width<T> + at.first;
    where(rigid, one, stiff / (one + stiff)).store_aligned(start);
    where(slope, before / where(slope, slope, one), zero).store_aligned(start + logical_width<T>);
    where(one_sided, lanes::max(before * split, zero), Batch<T>(-std::numeric_limits<T>::infinity()))
        .store_aligned(start + 2 * logical_width<T>);
    length.store_aligned(start + 3 * logical_width<T>);
    excess.store_aligned(start + 4 * logical_width<T>);
    store_shift(block, at, {zero, zero, zero});
  }
}

/// Holds what every gradient needs of a rod.
template <class T>
struct Giving {
  Triple<T> d2, shift;
  Batch<T> violation, length, least_length, firm, off, least, omega;
};
template <class T>
PLUMB_INLINE Giving<T> load_giving(const LawView<T>& block, Position at) {
  const Batch<T> length = load_law(block, at, 0);
  return {load_direction(static_cast<const T*>(block.rod), at),
          load_shift(block, at),
          load_field<rod_fields>(static_cast<const T*>(block.rod), at, 3),
          length,
          Batch<T>(T(1e-6)) * length,
          load_start(block, at, 0),
          load_start(block, at, 1),
          load_start(block, at, 2),
          Batch<T>(block.omega)};
}

template <class T>
PLUMB_INLINE Triple<T> shift_new(const Giving<T>& rod, const Triple<T>& e) {
  const Batch<T> half(T(0.5));
  const Triple<T> free = e + rod.shift, sum = rod.d2 + free, end2 = sum + free;
  const Batch<T> end = half * lanes::sqrt(dot(end2, end2));
  const Batch<T> excess = (rod.violation + dot(free, sum)) / (end + rod.length);
  const Triple<T> along = (half / lanes::max(end, rod.least_length)) * end2;
  const Batch<T> last = dot(rod.shift, along), wanted = rod.firm * (excess + rod.off);
  return lanes::max(lanes::min(last + rod.omega * (wanted - last), end), rod.least) * along;
}

template <class T>
PLUMB_INLINE Triple<T> shift_old(const Giving<T>& rod, const Triple<T>& e, const Batch<T>& start_length) {
  const Batch<T> half(T(0.5)), soft = Batch<T>(T(1)) - rod.firm;
  const Triple<T> sum = rod.d2 + e, end2 = sum + e;
  const Batch<T> end = half * lanes::sqrt(dot(end2, end2));
  const Batch<T> excess = (rod.violation + dot(e, sum)) / (end + rod.length);
  const Triple<T> along = (half / lanes::max(start_length, rod.least_length)) * rod.d2;
  const Batch<T> reach = half * dot(end2, along);
  const Batch<T> cosine = lanes::max(reach / lanes::max(end, rod.least_length), Batch<T>(T(0.25)));
  const Batch<T> last = dot(rod.shift, along);
  const Batch<T> change = (rod.firm * (excess + rod.off) - soft * last) / (rod.firm * cosine + soft);
  return lanes::max(last + lanes::min(rod.omega * change, reach), rod.least) * along;
}

/// Returns by how much a cable shortens itself with gradient mid, see law_scalar.hpp.
template <class T>
PLUMB_INLINE Batch<T> cable_mid(const Giving<T>& rod, const Batch<T>& start_excess, const Batch<T>& free,
                                const Batch<T>& gain, const Batch<T>& linear, const Batch<T>& softness) {
  const Batch<T> zero(T(0)), half(T(0.5)), four(T(4));
  const Batch<T> sum = free + start_excess, part = softness * sum;
  const Batch<T> root =
      lanes::sqrt(lanes::max(part * part - four * (softness * (free * start_excess)), zero));
  const Batch<T> tightened =
      lanes::select(free > zero, lanes::max((free - half * (part + root)) / gain, zero), zero);
  const Batch<T> square = sum * sum - four * (start_excess * (free - gain * rod.least));
  const Batch<T> slack = half * (sum - lanes::sqrt(lanes::max(square, zero)));
  const Batch<T> loosened = rod.least * start_excess / lanes::max(start_excess - slack, rod.least_length);
  return lanes::select(start_excess < zero, tightened, lanes::select(linear > rod.least, linear, loosened));
}

/// Holds what a visit of gradient mid finds of a rod.
template <class T>
struct Middle {
  Triple<T> sum;
  Batch<T> both, push, last;
};
template <class T>
PLUMB_INLINE Middle<T> middle_of(const Giving<T>& rod, const Triple<T>& e, const Batch<T>& start_length) {
  const Batch<T> half(T(0.5)), zero(T(0));
  const Triple<T> sum = rod.d2 + e, end2 = sum + e;
  const Batch<T> end = half * lanes::sqrt(dot(end2, end2));
  const Batch<T> both = lanes::max(start_length + end, rod.least_length), push = half * both;
  const Batch<T> size =
      both * lanes::sqrt(dot(rod.shift, rod.shift) / lanes::max(dot(sum, sum), push * push));
  return {sum, both, push, lanes::select(dot(rod.shift, sum) < zero, zero - size, size)};
}

template <class T>
PLUMB_INLINE Triple<T> shift_mid(const Giving<T>& rod, const Triple<T>& e, const Batch<T>& start_length,
                                 const Batch<T>& start_excess, const Batch<T>& one_sided) {
  const Batch<T> zero(T(0)), one(T(1)), soft = one - rod.firm;
  const Middle<T> middle = middle_of(rod, e, start_length);
  const Batch<T> last = lanes::max(middle.last, zero - middle.push);
  const Triple<T> along = (one / (middle.both + last)) * (middle.sum + rod.shift);
  const Batch<T> gain = lanes::max(dot(along, along), Batch<T>(T(0.25)));
  const Batch<T> free = start_excess + dot(along, e + rod.shift);
  const Batch<T> over = one / (soft + rod.firm * gain);
  const Batch<T> linear = (rod.firm * (free + rod.off)) * over;
  const Batch<T> wanted =
      where(one_sided, cable_mid(rod, start_excess, free, gain, linear, soft * over), linear);
  const Batch<T> least = where(one_sided, zero, zero - middle.push);
  const Batch<T> reach = (free + rod.length) / gain;
  return lanes::max(lanes::min(last + rod.omega * (wanted - last), reach), least) * along;
}

/// Returns 1 for rods that a bound of gradient mid holds, else 0.
template <class T>
PLUMB_INLINE Batch<T> is_lost(const Giving<T>& rod, const Triple<T>& e, const Batch<T>& start_length) {
  const Batch<T> zero(T(0)), one(T(1));
  const Middle<T> middle = middle_of(rod, e, start_length);
  const Batch<T> turned = lanes::select(dot(middle.sum, middle.sum) < middle.push * middle.push, one, zero);
  return lanes::select(middle.last < Batch<T>(T(-0.99)) * middle.push, one, turned);
}

/// Returns by how much a rod, whose vector has moved by e, is to be moved in all.
template <Gradient gradient, class T>
PLUMB_INLINE Triple<T> next_shift(const LawView<T>& block, Position at, const Giving<T>& rod,
                                  const Triple<T>& e) {
  if constexpr (gradient == Gradient::new_) return shift_new(rod, e);
  if constexpr (gradient == Gradient::old) return shift_old(rod, e, load_start(block, at, 3));
  return shift_mid(rod, e, load_start(block, at, 3), load_start(block, at, 4), load_law(block, at, 5));
}

template <class Access, Gradient gradient, class T>
PLUMB_INLINE void visit(const LawView<T>& block, Position at) {
  typename Access::template Kept<T> kept;
  const Triple<T> e = movement<Access, T>(block, at, kept);
  const Giving<T> rod = load_giving(block, at);
  const Triple<T> next = next_shift<gradient>(block, at, rod, e), change = next - rod.shift;
  store_shift(block, at, next);
  move<Access, T>(block, at, kept, load_field<weight_fields>(block.weight, at, 1) * change,
                  load_field<weight_fields>(block.weight, at, 2) * change);
}

template <class Access, Gradient gradient, class T>
void sweep_laws(const LawView<T>& shared, const Range* ranges, std::uint32_t count) {
  const LawView<T> block = shared;  // stores through its pointers cannot change a copy
  for (const Range* range = ranges; range != ranges + count; ++range)
    for (std::size_t i = 0; i < (range->end - range->begin) * parts<T>; ++i)
      visit<Access, gradient>(block, position<T>(range->begin, i));
}

template <class Access, Gradient gradient, class T>
T violation_laws(const LawView<T>& block, Range range) {
  Batch<T> largest(T(0));
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const Position at = position<T>(range.begin, i);
    const Triple<T> e = Access::difference(block, static_cast<const T*>(block.p), at);
    const Giving<T> rod = load_giving(block, at);
    const Triple<T> change = next_shift<gradient>(block, at, rod, e) - rod.shift;
    const Batch<T> scale = (rod.length + rod.length) * load_field<weight_fields>(block.weight, at, 3);
    largest = lanes::max(lanes::sqrt(dot(change, change)) * scale, largest);
    if constexpr (gradient == Gradient::mid)
      largest = lanes::max(is_lost(rod, e, load_start(block, at, 3)) * (rod.length * scale), largest);
  }
  return largest_lane(largest);
}

template <class T>
void finish_laws(const LawView<T>& block, Range range) {
  const Batch<T> zero(T(0)), half(T(0.5));
  for (std::size_t i = 0; i < (range.end - range.begin) * parts<T>; ++i) {
    const Position at = position<T>(range.begin, i);
    const Giving<T> rod = load_giving(block, at);
    T* half_kick = block.half_kick + at.v * logical_width<T> + at.first;
    const Triple<T> along = (half / lanes::max(load_start(block, at, 3), rod.least_length)) * rod.d2;
    const Batch<T> own = dot(rod.shift, along) / load_law(block, at, 3) -
                         Batch<T>(block.terms.kick_before) * Batch<T>::load_aligned(half_kick);
    const Batch<T> gives = load_law(block, at, 1) + load_law(block, at, 2);
    where(gives, Batch<T>(block.terms.keep) * own, zero).store_aligned(half_kick);
  }
}

template <class Access, class T>
constexpr LawKernels<T> law_kernels = {
    prepare_laws<Access, T>,
    {sweep_laws<Access, Gradient::new_, T>, sweep_laws<Access, Gradient::old, T>,
     sweep_laws<Access, Gradient::mid, T>},
    {violation_laws<Access, Gradient::new_, T>, violation_laws<Access, Gradient::old, T>,
     violation_laws<Access, Gradient::mid, T>},
    finish_laws<T>,
};

}  // namespace
}  // namespace plumb::simd
