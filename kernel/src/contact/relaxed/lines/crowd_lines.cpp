#include "contact/relaxed/lines/crowd_lines.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "contact/relaxed/visits/share_ranges.hpp"
#include "contact/rows.hpp"
#include "contact/shapes/passing.hpp"

namespace plumb::detail {

namespace fields = simd::line_contact_fields;

// --- Which pairs there are

template <class T>
void CrowdLines<T>::begin_step(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                               const CrowdPairs<T>& near) {
  known_.clear();
  others_.clear();
  left_.clear();
  pairs_.clear();
  color_.clear();
  forces_.clear();
  held_.clear();
  slots_.clear();
  ranges_.clear();
  is_first_ = true;
  sees_blows_ = std::any_of(cluster.begin(), cluster.end(),
                            [](const LinkageState* state) { return state->pulls.are_asked_for(); });
  taken_.assign(crowd.places().particles(), 0);
  list_lines(near);
}

template <class T>
void CrowdLines<T>::list_lines(const CrowdPairs<T>& near) {
  lines_.clear();
  over_mass_ = 0;
  bool are_alike = true;
  for (const auto& body : near.bodies()) {
    Line& line = lines_.emplace_back();
    line.is_plain = body.is_line();
    if (!line.is_plain) continue;
    line.at = body.at;
    line.friction = body.shape->surface.friction;
    for (std::size_t k = 0; k < 2; ++k) {
      const T over_mass = static_cast<T>(near.terms_of(k == 0 ? body.a : body.b).front().move);
      line.over_mass[k] = over_mass;
      line.is_plain = line.is_plain && over_mass > 0;
    }
    if (!line.is_plain) continue;
    sees_blows_ = sees_blows_ || body.shape->surface.restitution > 0;
    if (over_mass_ == 0) over_mass_ = line.over_mass[0];
    are_alike = are_alike && line.over_mass[0] == over_mass_ && line.over_mass[1] == over_mass_;
  }
  if (!are_alike) over_mass_ = 0;
}

/// Takes in pairs that were not known. Within a step pairs come, and none goes.
template <class T>
void CrowdLines<T>::add_pairs(const CrowdPairs<T>& near) {
  const std::span<const Pair> pairs = near.pairs();
  if (pairs.size() == known_.size()) return;
  auto known = known_.begin();
  for (const Pair& pair : pairs) {
    if (known != known_.end() && *known == pair) {
      ++known;
      continue;
    }
    const Line &a = lines_[pair.one], &b = lines_[pair.other];
    const auto joins = [&](std::uint32_t at) { return at == b.at[0] || at == b.at[1]; };
    if (!a.is_plain || !b.is_plain || joins(a.at[0]) || joins(a.at[1])) {
      others_.push_back(pair);
      continue;
    }
    pairs_.push_back({pair.one, pair.other});
  }
  color_.resize(pairs_.size(), no_color);
  forces_.resize(places * pairs_.size());
  known_.assign(pairs.begin(), pairs.end());
}

// --- Contacts of a substep

template <class T>
void CrowdLines<T>::find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                         const CrowdPairs<T>& near, const Placed& placed, Team* team) {
  add_pairs(near);
  left_.assign(others_.begin(), others_.end());
  find_touches(placed.lines, team);
  classify(crowd.places());
  if (is_first_) load_kept(cluster, near);
  reserve(crowd.places());
  for (const auto& of_part : touches_)
    for (const simd::LineTouch& touch : of_part)
      if (touch.which != simd::LineTouch::fast)
        put(touch, next_[places * color_[touch.pair] + touch.which]++, placed);
  if (sees_blows_) see_blows(crowd, near, placed.h);
}

/// Lists where pairs touch, in their order, and those that are fast.
template <class T>
void CrowdLines<T>::find_touches(const double* lines, Team* team) {
  const auto count = static_cast<std::uint32_t>(pairs_.size());
  const unsigned parts = team == nullptr ? 1 : team->parts();
  touches_.resize(parts);
  auto find = [&](unsigned part) {
    Array<simd::LineTouch>& to = touches_[part];
    to.clear();
    std::array<simd::LineTouch, std::size_t{places} * simd::most_line_pairs> found;
    const std::uint32_t end = Team::begin_of(count, part + 1, parts);
    for (std::uint32_t first = Team::begin_of(count, part, parts); first < end;
         first += simd::most_line_pairs) {
      const std::uint32_t more =
          kernels_->lines.find(lines, &pairs_[first], std::min(simd::most_line_pairs, end - first),
                               {settings_.margin, PairSearch::passes}, found.data());
      for (std::uint32_t k = 0; k < more; ++k) found[k].pair += first;
      to.insert(to.end(), found.begin(), found.begin() + more);
    }
  };
  if (team == nullptr)
    find(0);
  else
    team->for_parts(find);
}

/// Gives a pair that touches a colour. Returns false if too many contacts move its particles.
template <class T>
bool CrowdLines<T>::has_color(const CrowdPlaces& of, std::uint32_t pair) {
  if (color_[pair] != no_color) return true;
  std::array<std::uint64_t*, ends> masks;
  for (std::uint32_t k = 0; k < ends; ++k) {
    const Line& line = lines_[k < 2 ? pairs_[pair].one : pairs_[pair].other];
    masks[k] = &taken_[of.particle_at(line.at[k % 2])];
  }
  const std::uint64_t taken = *masks[0] | *masks[1] | *masks[2] | *masks[3];
  if (taken == ~std::uint64_t{0}) return false;
  const int color = std::countr_one(taken);
  for (std::uint64_t* const mask : masks) *mask |= std::uint64_t{1} << color;
  color_[pair] = static_cast<std::uint8_t>(color);
  return true;
}

/// Counts the contacts of each class, and leaves to others what is fast or has no colour. What is left is
/// marked as fast.
template <class T>
void CrowdLines<T>::classify(const CrowdPlaces& of) {
  next_.fill(0);
  for (auto& of_part : touches_)
    for (simd::LineTouch& touch : of_part) {
      if (touch.which != simd::LineTouch::fast && has_color(of, touch.pair)) {
        ++next_[places * color_[touch.pair] + touch.which];
        continue;
      }
      touch.which = simd::LineTouch::fast;
      const Pair pair{pairs_[touch.pair].one, pairs_[touch.pair].other};
      if (left_.empty() || left_.back() != pair) left_.push_back(pair);
    }
}

template <class T>
std::uint64_t CrowdLines<T>::key_of(std::span<LinkageState* const> cluster, const CrowdPairs<T>& near,
                                    std::size_t slot) const {
  const auto& [one, other] = pairs_[slot / places];
  const auto &a = near.bodies()[one], &b = near.bodies()[other];
  return contact_key(KeyKind::island, 4 * std::uint64_t{a.number} + slot % places, cluster[b.island]->number,
                     b.number);
}

/// Takes up what held those that touch in the last step.
template <class T>
void CrowdLines<T>::load_kept(std::span<LinkageState* const> cluster, const CrowdPairs<T>& near) {
  kept_.gather(cluster);
  std::size_t next = 0;
  for (const auto& of_part : touches_)
    for (const simd::LineTouch& touch : of_part) {
      if (touch.which == simd::LineTouch::fast) continue;
      const std::uint32_t island = near.bodies()[pairs_[touch.pair].one].island;
      if (cluster[island]->kept.empty()) continue;
      const std::size_t slot = places * std::size_t{touch.pair} + touch.which;
      const KeptContact* const held = kept_.find(*cluster[island], island, key_of(cluster, near, slot), next);
      forces_[slot] = held != nullptr ? held->force : Vec3{};
    }
}

/// Gives every class a range of vectors, and makes counts the first lanes there.
template <class T>
void CrowdLines<T>::reserve(const CrowdPlaces& of) {
  ranges_.clear();
  std::uint32_t vectors = 0;
  for (std::uint32_t& next : next_) {
    if (next == 0) continue;
    const std::uint32_t begin = vectors;
    vectors += (next + lanes - 1) / lanes;
    ranges_.push_back({begin, vectors, ends});
    next = begin * lanes;
  }
  const std::size_t size = std::size_t{vectors} * lanes;
  if (fields_.size() < size * fields_each()) {
    const std::size_t room = size + size / 4;  // as contacts come one after the other
    fields_ = layouts::AlignedBuffer<T>(room * fields_each());
    at_.reserve(room * ends);
    slots_.reserve(room);
  }
  at_.resize(size * ends);
  slots_.resize(size);
  // Lanes that get no contact are in the last vectors of ranges. The others are written as a whole.
  for (const simd::ContactRange& range : ranges_) {
    const std::size_t last = range.end - 1;
    std::fill_n(&fields_[last * fields_each() * lanes], fields_each() * lanes, T(0));
    std::fill_n(&at_[last * ends * lanes], ends * lanes, of.numbers());
    std::fill_n(&slots_[last * lanes], lanes, none);
  }
}

template <class T>
void CrowdLines<T>::put(const simd::LineTouch& touch, std::size_t lane, const Placed& placed) {
  const std::size_t slot = places * std::size_t{touch.pair} + touch.which;
  const Line &one = lines_[pairs_[touch.pair].one], &other = lines_[pairs_[touch.pair].other];
  T* const own = &field(lane, 0);
  const auto set = [&](std::uint32_t number, double value) { own[number * lanes] = static_cast<T>(value); };
  const auto set3 = [&](std::uint32_t first, Vec3 value) {
    set(first, value.x);
    set(first + 1, value.y);
    set(first + 2, value.z);
  };
  const Vec3 normal{touch.x, touch.y, touch.z}, force = forces_[slot];
  set3(fields::normal, normal);
  set(fields::gap, recovered(touch.gap, settings_.slop, placed.share));
  // What held it does so again, unless it would pull along the new normal.
  set3(fields::push, (dot(force, normal) > 0 ? placed.h * placed.h : 0) * force);
  set(fields::friction, std::sqrt(one.friction * other.friction));
  set(fields::a, touch.a);
  set(fields::b, touch.b);
  std::uint32_t* const places_of = &at_[lane / lanes * ends * lanes + lane % lanes];
  const std::array<double, ends> weight{1 - touch.a, touch.a, 1 - touch.b, touch.b};
  double moves = 0;
  for (std::uint32_t k = 0; k < ends; ++k) {
    const Line& line = k < 2 ? one : other;
    places_of[k * lanes] = line.at[k % 2];
    moves += weight[k] * weight[k] * line.over_mass[k % 2];
    if (over_mass_ == 0) own[(fields::over_mass + k) * lanes] = line.over_mass[k % 2];
  }
  set(fields::over, 1 / moves);
  slots_[lane] = static_cast<std::uint32_t>(slot);
}

template <class T>
void CrowdLines<T>::start(Crowd<T>& crowd) {
  kernels(crowd).start(view(crowd), ranges_.data(), static_cast<std::uint32_t>(ranges_.size()));
}

template <class T>
void CrowdLines<T>::sweep(Crowd<T>& crowd, Team* team) {
  sweep_ranges(team, ranges_, kernels(crowd), view(crowd));
}

template <class T>
double CrowdLines<T>::measured_sweep(Crowd<T>& crowd, Team* team) {
  return measure_ranges(team, ranges_, kernels(crowd), view(crowd));
}

template <class T>
void CrowdLines<T>::end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                        const CrowdPairs<T>& near, double h) {
  for (const std::uint32_t slot : held_) forces_[slot] = {};
  held_.clear();
  is_first_ = false;
  for_contacts([&](std::size_t lane) {
    if (!is_pushed(lane)) return;
    forces_[slots_[lane]] = 1 / (h * h) * vector(lane, fields::push);
    held_.push_back(slots_[lane]);
    if (sees_blows_) count_push(cluster, crowd, near, lane, h);
  });
}

template <class T>
void CrowdLines<T>::keep(std::span<LinkageState* const> cluster, const CrowdPairs<T>& near) const {
  if (is_first_) return;
  for (std::size_t slot = 0; slot < forces_.size(); ++slot) {
    if (forces_[slot] == Vec3{}) continue;
    const auto& body = near.bodies()[pairs_[slot / places].one];
    cluster[body.island]->kept.push_back({key_of(cluster, near, slot), forces_[slot], {}});
  }
}

template <class T>
bool CrowdLines<T>::any_push() const {
  bool any = false;
  for_contacts([&](std::size_t lane) { any = any || is_pushed(lane); });
  return any;
}

template <class T>
std::size_t CrowdLines<T>::count_pushes() const {
  std::size_t out = 0;
  for_contacts([&](std::size_t lane) { out += is_pushed(lane); });
  return out;
}

template class CrowdLines<float>;
template class CrowdLines<double>;

}  // namespace plumb::detail
