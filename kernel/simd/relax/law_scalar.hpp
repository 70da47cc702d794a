// The visit of a rod that gives, one rod at a time, written for reading. law_lanes.hpp must give the same
// bits.
//
// A rod of length l pulls with k (l - L) + r dl/dt (plumb::RodLaw). In a substep its pull shortens its vector
// d + e by a shift s along a direction u: end a moves by share_a s, and end b by -share_b s. With l0 and l1
// its lengths at the start and at the end, and c = l - L, its law is
//
//   |s| = slope (c1 + off),    slope = w (kick k share + damping r).
//
// off is what the length at the start and, with gradient old, the last substep add. A rigid rod has slope =
// infinity and off = 0. firm = slope/(1 + slope) is finite for all rods, and 0 for what pulls nothing.
//
// A visit takes the rod's shift back, asks how far it would be off its length then, and gives it the shift
// that obeys the law. Shifts are kept as vectors, since directions turn while sweeps converge. What they
// converge to is the equation that method direct solves (simd/tree/law_math.hpp).

#pragma once

#include <cmath>
#include <limits>

#include "simd/relax/scalar_access.hpp"

namespace plumb::simd {
namespace {

template <class T>
T larger(T a, T b) {
  return a > b ? a : b;
}
template <class T>
T smaller(T a, T b) {
  return a < b ? a : b;
}
template <class T>
Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Triple<T> operator*(T s, const Triple<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

/// Reads and writes field `field` of a rod in an array of `fields` fields.
template <std::uint32_t fields, class T>
T& field_of(T* data, std::uint32_t v, std::uint32_t lane, std::uint32_t field) {
  return data[(std::size_t{v} * fields + field) * logical_width<T> + lane];
}
template <class T>
Triple<T> shift_at(const LawView<T>& block, std::uint32_t v, std::uint32_t lane) {
  constexpr std::uint32_t n = law_fields::shift;
  return {field_of<n>(block.shift, v, lane, 0), field_of<n>(block.shift, v, lane, 1),
          field_of<n>(block.shift, v, lane, 2)};
}
template <class T>
void put_shift(const LawView<T>& block, std::uint32_t v, std::uint32_t lane, const Triple<T>& shift) {
  constexpr std::uint32_t n = law_fields::shift;
  field_of<n>(block.shift, v, lane, 0) = shift.x;
  field_of<n>(block.shift, v, lane, 1) = shift.y;
  field_of<n>(block.shift, v, lane, 2) = shift.z;
}

/// These numbers hold for one substep. They lie in this order in law_fields::start.
template <class T>
struct LawStart {
  T firm;    ///< slope/(1 + slope)
  T off;     ///< In m.
  T least;   ///< A cable never pulls by less, though it be slack at the end of the substep, in m.
  T length;  ///< l0, in m.
  T excess;  ///< c0, in m.
};

/// Gradient old takes k/2 ((c0 + c1)/2)^2 for the potential of a substep, mid k/2 c^2 at both ends, and new
/// c1 alone. What gradient old does not resolve, (h omega)^2 > 1, it takes more of c1 than of c0, which damps
/// it.
template <class T>
LawStart<T> start_of(const LawView<T>& block, std::uint32_t v, std::uint32_t lane) {
  const auto law = [&](std::uint32_t field) { return field_of<law_fields::rod>(block.law, v, lane, field); };
  const auto rod = [&](std::uint32_t field) { return field_of<rod_fields>(block.rod, v, lane, field); };
  const LawTerms<T>& terms = block.terms;
  const Triple<T> d2{rod(0), rod(1), rod(2)};
  const T length = T(0.5) * std::sqrt(dot(d2, d2)), excess = rod(3) / (length + law(0));
  const T frequency2 = law(1), split = law(3);
  const bool rigid = law(4) != 0, one_sided = law(5) != 0;

  const T fast = larger((terms.substep * terms.substep) * frequency2 - 1, T(0));
  const T share = terms.share + T(0.5) * (fast / (1 + fast));
  const T pull = terms.kick * frequency2, damps = terms.damping * law(2);
  const T slope = pull * share + damps;
  const T taut = one_sided ? larger(excess, T(0)) : excess;
  const T before =
      (pull * (1 - share) - damps) * taut + terms.kick_before * field_of<1>(block.half_kick, v, lane, 0);
  const T stiff = slope * split;
  return {rigid ? T(1) : stiff / (1 + stiff), slope != 0 ? before / slope : T(0),
          one_sided ? larger(before * split, T(0)) : -std::numeric_limits<T>::infinity(), length, excess};
}

template <AccessKind access, class T>
void prepare_laws(const LawView<T>& block, Range range) {
  prepare<access, T>(block, {range.begin, range.end, false});
  for (std::uint32_t v = range.begin; v < range.end; ++v)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) {
      const LawStart<T> start = start_of(block, v, lane);
      const T numbers[law_fields::start] = {start.firm, start.off, start.least, start.length, start.excess};
      for (std::uint32_t i = 0; i < law_fields::start; ++i)
        field_of<law_fields::start>(block.start, v, lane, i) = numbers[i];
      put_shift(block, v, lane, {0, 0, 0});
    }
}

/// A rod as a visit finds it. Lengths below least_length are taken for it where something is divided by them.
template <class T>
struct Giving {
  Triple<T> d2, e, shift;  ///< 2 d, how far its vector has moved, and its own part in that
  T violation;             ///< |d|^2 - L^2
  T length, least_length;  ///< L
  bool one_sided;
  LawStart<T> start;
  T omega;
};
template <AccessKind access, class T>
Giving<T> giving(const LawView<T>& block, std::uint32_t v, std::uint32_t lane) {
  const auto rod = [&](std::uint32_t field) { return field_of<rod_fields>(block.rod, v, lane, field); };
  const auto start = [&](std::uint32_t i) { return field_of<law_fields::start>(block.start, v, lane, i); };
  const auto a = load<T>(block.p, address<access, T>(block.address_a, v, lane), block.component_stride);
  const auto b = load<T>(block.p, address<access, T>(block.address_b, v, lane), block.component_stride);
  const T length = field_of<law_fields::rod>(block.law, v, lane, 0);
  return {{rod(0), rod(1), rod(2)},
          b - a,
          shift_at(block, v, lane),
          rod(3),
          length,
          T(1e-6) * length,
          field_of<law_fields::rod>(block.law, v, lane, 5) != 0,
          {start(0), start(1), start(2), start(3), start(4)},
          block.omega};
}

/// Along the new direction a pull does not turn a rod: without it the rod's vector has the same direction,
/// and its length is l1 + |s|. So the law is solved by |s| = firm (l1 + |s| - L + off). Over-relaxation turns
/// no rod round.
template <class T>
Triple<T> shift_new(const Giving<T>& rod) {
  const Triple<T> free = rod.e + rod.shift, sum = rod.d2 + free, end2 = sum + free;
  const T end = T(0.5) * std::sqrt(dot(end2, end2));
  const T excess = (rod.violation + dot(free, sum)) / (end + rod.length);
  const Triple<T> along = (T(0.5) / larger(end, rod.least_length)) * end2;
  const T last = dot(rod.shift, along), wanted = rod.start.firm * (excess + rod.start.off);
  return larger(smaller(last + rod.omega * (wanted - last), end), rod.start.least) * along;
}

/// Along the old direction a visit takes a step of Newton's method. The cosine is that between the rod's
/// direction then and now. A rod is shortest at a right angle to its old direction, and never moved further.
template <class T>
Triple<T> shift_old(const Giving<T>& rod) {
  const T firm = rod.start.firm, soft = 1 - firm;
  const Triple<T> sum = rod.d2 + rod.e, end2 = sum + rod.e;
  const T end = T(0.5) * std::sqrt(dot(end2, end2));
  const T excess = (rod.violation + dot(rod.e, sum)) / (end + rod.length);
  const Triple<T> along = (T(0.5) / larger(rod.start.length, rod.least_length)) * rod.d2;
  const T reach = T(0.5) * dot(end2, along);
  const T cosine = larger(reach / larger(end, rod.least_length), T(0.25));
  const T last = dot(rod.shift, along);
  const T change = (firm * (excess + rod.start.off) - soft * last) / (firm * cosine + soft);
  return larger(last + smaller(rod.omega * change, reach), rod.start.least) * along;
}

/// With gradient mid, a cable pulls by the share of its change of length that it was taut in, so that its
/// pull is the change of its energy over that of its length. `free` is c1 without its pull, of which c1 =
/// free - gain |s|. `linear` is the solution of a rod that pushes, too. The other two cases solve a quadratic
/// equation for c1.
template <class T>
T cable_mid(const Giving<T>& rod, T free, T gain, T linear, T softness) {
  const T before = rod.start.excess, least = rod.start.least;
  const T sum = free + before, part = softness * sum;
  if (before < 0) {  // It was slack, and |s| = slope c1^2/(c1 - c0).
    const T root = std::sqrt(larger(part * part - 4 * (softness * (free * before)), T(0)));
    return free > 0 ? larger((free - T(0.5) * (part + root)) / gain, T(0)) : T(0);
  }
  if (linear > least) return linear;
  // It is slack at the end, and |s| = least c0/(c0 - c1).
  const T root = std::sqrt(larger(sum * sum - 4 * (before * (free - gain * least)), T(0)));
  return least * before / larger(before - T(0.5) * (sum - root), rod.least_length);
}

/// What a visit of gradient mid finds of a rod. `push` is half of its lengths at start and end, `both`.
template <class T>
struct Middle {
  Triple<T> sum;  ///< 2 m
  T both, push;
  T last;  ///< |s|, below 0 if it pushes
};
template <class T>
Middle<T> middle_of(const Giving<T>& rod) {
  const Triple<T> sum = rod.d2 + rod.e, end2 = sum + rod.e;
  const T end = T(0.5) * std::sqrt(dot(end2, end2));
  const T both = larger(rod.start.length + end, rod.least_length), push = T(0.5) * both;
  const T size = both * std::sqrt(dot(rod.shift, rod.shift) / larger(dot(sum, sum), push * push));
  return {sum, both, push, dot(rod.shift, sum) < 0 ? 0 - size : size};
}

/// Along the middle direction m = d + e/2 the change of length is m.e divided by the mean length. Without the
/// shift, m would be longer by half of it. So m is found from what it would be then, which stays stable where
/// a pull is long beside the rod. Lengths and |s| are as the rod was found, and converge with the sweeps. A
/// rod pushes by no more than its length, and a gain below 1/4 is that of one which nearly turns round.
template <class T>
Triple<T> shift_mid(const Giving<T>& rod) {
  const T firm = rod.start.firm, soft = 1 - firm;
  const Middle<T> middle = middle_of(rod);
  const T last = larger(middle.last, 0 - middle.push);
  const Triple<T> along = (1 / (middle.both + last)) * (middle.sum + rod.shift);
  const T gain = larger(dot(along, along), T(0.25));
  const T free = rod.start.excess + dot(along, rod.e + rod.shift);
  const T over = 1 / (soft + firm * gain);
  const T linear = (firm * (free + rod.start.off)) * over;
  const T wanted = rod.one_sided ? cable_mid(rod, free, gain, linear, soft * over) : linear;
  const T reach = (free + rod.length) / gain, least = rod.one_sided ? T(0) : 0 - middle.push;
  return larger(smaller(last + rod.omega * (wanted - last), reach), least) * along;
}

/// Says whether either bound of gradient mid holds a rod, which then does not obey its law, though it rests.
template <class T>
bool is_lost(const Giving<T>& rod) {
  const Middle<T> middle = middle_of(rod);
  return dot(middle.sum, middle.sum) < middle.push * middle.push || middle.last < T(-0.99) * middle.push;
}

template <Gradient gradient, class T>
Triple<T> next_shift(const Giving<T>& rod) {
  if constexpr (gradient == Gradient::new_) return shift_new(rod);
  if constexpr (gradient == Gradient::old) return shift_old(rod);
  return shift_mid(rod);
}

template <AccessKind access, Gradient gradient, class T>
void visit(const LawView<T>& block, std::uint32_t v, std::uint32_t lane) {
  const Giving<T> rod = giving<access>(block, v, lane);
  const Triple<T> next = next_shift<gradient>(rod), change = next - rod.shift;
  put_shift(block, v, lane, next);
  const Triple<T> move_a = field_of<weight_fields>(block.weight, v, lane, 1) * change;
  const Triple<T> move_b = field_of<weight_fields>(block.weight, v, lane, 2) * change;
  T* const a = block.out + address<access, T>(block.address_a, v, lane);
  T* const b = block.out + address<access, T>(block.address_b, v, lane);
  const std::uint32_t stride = block.component_stride;
  a[0] += move_a.x;
  a[stride] += move_a.y;
  a[2 * stride] += move_a.z;
  b[0] -= move_b.x;
  b[stride] -= move_b.y;
  b[2 * stride] -= move_b.z;
}

template <AccessKind access, Gradient gradient, class T>
void sweep_laws(const LawView<T>& block, const Range* ranges, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t v = ranges[i].begin; v < ranges[i].end; ++v)
      for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) visit<access, gradient>(block, v, lane);
}

template <AccessKind access, Gradient gradient, class T>
T violation_laws(const LawView<T>& block, Range range) {
  T largest = 0;
  for (std::uint32_t v = range.begin; v < range.end; ++v)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) {
      const Giving<T> rod = giving<access>(block, v, lane);
      const Triple<T> change = next_shift<gradient>(rod) - rod.shift;
      const T scale = (rod.length + rod.length) * field_of<weight_fields>(block.weight, v, lane, 3);
      largest = larger(std::sqrt(dot(change, change)) * scale, largest);
      if (gradient == Gradient::mid && is_lost(rod)) largest = larger(rod.length * scale, largest);
    }
  return largest;
}

/// Gradient old gives a rod's own pull once more to the next substep, where it acts along the rod's new
/// direction.
template <AccessKind access, class T>
void finish_laws(const LawView<T>& block, Range range) {
  for (std::uint32_t v = range.begin; v < range.end; ++v)
    for (std::uint32_t lane = 0; lane < logical_width<T>; ++lane) {
      const auto law = [&](std::uint32_t i) { return field_of<law_fields::rod>(block.law, v, lane, i); };
      const Giving<T> rod = giving<access>(block, v, lane);
      T& half_kick = field_of<1>(block.half_kick, v, lane, 0);
      const Triple<T> along = (T(0.5) / larger(rod.start.length, rod.least_length)) * rod.d2;
      const T own = dot(rod.shift, along) / law(3) - block.terms.kick_before * half_kick;
      half_kick = law(1) + law(2) != 0 ? block.terms.keep * own : T(0);
    }
}

template <AccessKind access, class T>
constexpr LawKernels<T> law_kernels = {
    prepare_laws<access, T>,
    {sweep_laws<access, Gradient::new_, T>, sweep_laws<access, Gradient::old, T>,
     sweep_laws<access, Gradient::mid, T>},
    {violation_laws<access, Gradient::new_, T>, violation_laws<access, Gradient::old, T>,
     violation_laws<access, Gradient::mid, T>},
    finish_laws<access, T>,
};

}  // namespace
}  // namespace plumb::simd
