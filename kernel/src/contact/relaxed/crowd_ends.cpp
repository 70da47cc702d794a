#include "contact/relaxed/crowd_ends.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/rows.hpp"

namespace plumb::detail {

namespace fields = simd::end_fields;

// --- Which ends there are

template <class T>
void CrowdEnds<T>::clear() {
  groups_.clear();
  ends_.clear();
  at_.clear();
  touched_.clear();
  touching_.clear();
  restitution_.clear();
  sees_bounces_ = false;
}

template <class T>
auto CrowdEnds<T>::group_of(const Crowd<T>& crowd, const Surroundings& surroundings, const GroundNow& ground,
                            std::uint32_t number) const -> Group {
  const auto first = static_cast<std::uint32_t>(ends_.size() / lanes);
  const auto three = [](T* to, Vec3 v) {
    to[0] = static_cast<T>(v.x);
    to[1] = static_cast<T>(v.y);
    to[2] = static_cast<T>(v.z);
  };
  Group out{.range = {first, first}, .ground = {}, .shape = none, .number = 0};
  const auto planes = static_cast<std::uint32_t>(ground.planes().size());
  if (number < planes) {
    const Plane& plane = ground.planes()[number];
    out.number = surroundings.numbers.of_plane(number);
    out.ground.is_plane = true;
    three(out.ground.place, plane.normal);
    out.ground.far = static_cast<T>(plane.offset - dot(plane.normal, crowd.origin()));
    return out;
  }
  out.shape = number - planes;
  const GroundShape& shape = surroundings.shapes[out.shape];
  const Segment line = *shape.capsule();
  const Vec3 along = line.q - line.p;
  const double square = dot(along, along);
  out.number = surroundings.number_of(out.shape);
  three(out.ground.place, line.p - crowd.origin());
  three(out.ground.along, along);
  out.ground.inverse = static_cast<T>(square > 0 ? 1 / square : 0);
  out.ground.far = static_cast<T>(line.radius);
  return out;
}

template <class T>
void CrowdEnds<T>::start_group(const CrowdPlaces& places) {
  filled_ = ends_.size();
  if (in_rows_) vector_of_row_.assign(places.numbers() / places.pitch(), none);
}

/// Adds a vector without ends, in rows that of a place.
template <class T>
void CrowdEnds<T>::add_vector(const CrowdPlaces& places, std::uint32_t place) {
  const std::size_t first = ends_.size() * fields::count, end = first + lanes * fields::count;
  if (fields_.size() < end) {
    layouts::AlignedBuffer<T> larger(2 * end);
    std::copy_n(fields_.data(), first, larger.data());
    fields_ = std::move(larger);
  }
  std::fill(fields_.data() + first, fields_.data() + end, T(0));
  if (in_rows_)
    at_.push_back(place / places.pitch() * places.pitch());
  else
    at_.insert(at_.end(), lanes, places.numbers());
  ends_.resize(ends_.size() + lanes);
  restitution_.resize(ends_.size());
  touched_.push_back(0);
}

/// Returns the lane that an end at a place is to have in the last group.
template <class T>
std::size_t CrowdEnds<T>::lane_for(const CrowdPlaces& places, std::uint32_t place) {
  if (!in_rows_) {
    if (filled_ == ends_.size()) add_vector(places, place);
    at_[filled_] = place;
    return filled_++;
  }
  std::uint32_t& vector = vector_of_row_[place / places.pitch()];
  if (vector == none) {
    vector = static_cast<std::uint32_t>(ends_.size() / lanes);
    add_vector(places, place);
  }
  return std::size_t{vector} * lanes + place % places.pitch();
}

template <class T>
void CrowdEnds<T>::add_lane(const Crowd<T>& crowd, const CrowdPairs<T>& near, const Pair& pair,
                            std::uint64_t key, const Surface& surface) {
  const auto& each = near.balls()[pair.one];
  const std::uint32_t particle = each.ball->center[0].particle;
  const Surface& own = each.ball->surface;
  const double moves = crowd.inverse_mass(each.island, particle);
  const std::size_t lane = lane_for(crowd.places(), crowd.number_of(each.island, particle));
  ends_[lane] = {.island = each.island, .shape = each.ball->shape, .key = key};
  restitution_[lane] = std::max(own.restitution, surface.restitution);
  field(lane, fields::moves) = static_cast<T>(moves);
  field(lane, fields::mass) = static_cast<T>(1 / moves);
  field(lane, fields::friction) = static_cast<T>(std::sqrt(own.friction * surface.friction));
  field(lane, fields::radius) = static_cast<T>(each.ball->radius);
}

template <class T>
void CrowdEnds<T>::add(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                       const CrowdPairs<T>& near, const Surroundings& surroundings, const GroundNow& ground,
                       std::span<const Pair> pairs) {
  if (pairs.empty()) return;
  in_rows_ = crowd.places().access() == layouts::Access::rows;
  kernels_ = in_rows_ ? &all_kernels_->row_ends : &all_kernels_->ends;
  const std::size_t first = ends_.size();
  for (std::size_t i = 0; i < pairs.size();) {
    Group group = group_of(crowd, surroundings, ground, pairs[i].other);
    const bool is_plane = group.shape == none;
    const Surface& surface =
        is_plane ? ground.planes()[pairs[i].other].surface : surroundings.shapes[group.shape].surface();
    start_group(crowd.places());
    for (const std::uint32_t other = pairs[i].other; i < pairs.size() && pairs[i].other == other; ++i) {
      const std::uint32_t ball = pairs[i].one;
      add_lane(crowd, near, pairs[i],
               is_plane ? contact_key(KeyKind::plane, near.balls()[ball].number, 0, other)
                        : ground_key(GroundPart::end, ball, group.shape, 0),
               surface);
    }
    group.range.end = static_cast<std::uint32_t>(ends_.size() / lanes);
    groups_.push_back(group);
  }
  sees_bounces_ = false;
  for (std::size_t lane = 0; lane < ends_.size() && !sees_bounces_; ++lane)
    sees_bounces_ = ends_[lane].island != none &&
                    (restitution_[lane] > 0 || cluster[ends_[lane].island]->pulls.are_asked_for());
  load_forces(cluster, first);
}

/// Takes up what held ends, from the lane `first` on.
template <class T>
void CrowdEnds<T>::load_forces(std::span<LinkageState* const> cluster, std::size_t first) {
  kept_.gather(cluster);
  std::size_t next = 0;
  for (std::size_t lane = first; lane < ends_.size(); ++lane) {
    const End& end = ends_[lane];
    if (end.island == none || cluster[end.island]->kept.empty()) continue;
    const KeptContact* const held = kept_.find(*cluster[end.island], end.island, end.key, next);
    if (held == nullptr) continue;
    field(lane, fields::force) = static_cast<T>(held->force.x);
    field(lane, fields::force + 1) = static_cast<T>(held->force.y);
    field(lane, fields::force + 2) = static_cast<T>(held->force.z);
  }
}

template <class T>
void CrowdEnds<T>::add_thrown(std::span<LinkageState* const> cluster, Crowd<T>& crowd,
                              const CrowdPairs<T>& near, const Surroundings& surroundings,
                              const GroundNow& ground, double share) {
  const std::size_t first = groups_.size();
  add(cluster, crowd, near, surroundings, ground, near.more_plain_ends());
  // Nothing is as near as that, and nothing held them.
  const simd::EndRules<T> rules = rules_of(std::numeric_limits<T>::lowest(), share, 0);
  for (const Group& group : std::span(groups_).subspan(first))
    kernels_->find(view(crowd), group.range, group.ground, rules, touched_.data());
}

// --- A substep

template <class T>
void CrowdEnds<T>::find(Crowd<T>& crowd, const Surroundings& surroundings, double h, double share) {
  const simd::EndRules<T> rules = rules_of(settings_.margin, share, h * h);
  for (const Group& group : groups_)
    kernels_->find(view(crowd), group.range, group.ground, rules, touched_.data());
  list_touching();
  if (surroundings.shapes.size() > 1) uncover(crowd, surroundings);
  if (sees_bounces_) see_bounces(crowd, h);
}

template <class T>
void CrowdEnds<T>::list_touching() {
  touching_.clear();
  for (std::uint32_t v = 0; v < touched_.size(); ++v)
    if (touched_[v] != 0) touching_.push_back(v);
}

/// Lets those touch no more that touch other ground instead, which lies against it.
template <class T>
void CrowdEnds<T>::uncover(const Crowd<T>& crowd, const Surroundings& surroundings) {
  for (const Group& group : groups_) {
    if (group.shape == none) continue;
    for (std::size_t lane = group.range.begin * lanes; lane < group.range.end * lanes; ++lane) {
      if (!touches(lane)) continue;
      const Vec3 there = crowd.origin() + crowd.position(place(lane));
      const double distance = surroundings.shapes[group.shape].distance(there);
      if (!surroundings.is_covered(group.shape, {there, distance, vector(lane, fields::normal)},
                                   settings_.tolerance))
        continue;
      field(lane, fields::gap) = std::numeric_limits<T>::max();
      for (const std::uint32_t each : {fields::over, fields::push, fields::push + 1, fields::push + 2})
        field(lane, each) = 0;
    }
  }
}

/// Finds how fast ends are about to hit, and what they leave with.
template <class T>
void CrowdEnds<T>::see_bounces(const Crowd<T>& crowd, double h) {
  for_touching([&](std::size_t lane) {
    const Vec3 normal = vector(lane, fields::normal);
    End& end = ends_[lane];
    end.kick = 0;
    end.approach = relaxed_approach_of(field(lane, fields::gap), dot(normal, crowd.moved(place(lane))),
                                       dot(normal, crowd.velocity(place(lane))), h);
    end.bounce = bounce_of(restitution_[lane], settings_.bounce_speed, end.approach);
  });
}

template <class T>
void CrowdEnds<T>::start(Crowd<T>& crowd) {
  kernels_->start(view(crowd), touching_.data(), static_cast<std::uint32_t>(touching_.size()));
}

template <class T>
bool CrowdEnds<T>::find_missed(Crowd<T>& crowd, double h) {
  bool any = false;
  for (const Group& group : groups_)
    any |= kernels_->watch(view(crowd), group.range, static_cast<T>(settings_.slop), touched_.data());
  if (!any) return false;
  list_touching();
  if (sees_bounces_) see_bounces(crowd, h);
  return true;
}

template <class T>
void CrowdEnds<T>::sweep(Crowd<T>& crowd) {
  kernels_->sweep(view(crowd), touching_.data(), static_cast<std::uint32_t>(touching_.size()));
}

template <class T>
double CrowdEnds<T>::measured_sweep(Crowd<T>& crowd) {
  return kernels_->measure(view(crowd), touching_.data(), static_cast<std::uint32_t>(touching_.size()));
}

template <class T>
double CrowdEnds<T>::depth(const Crowd<T>& crowd) const {
  double most = 0;
  for_touching([&](std::size_t lane) { most = std::max(most, depth(crowd, lane)); });
  return most;
}

template <class T>
bool CrowdEnds<T>::sweep_deep(Crowd<T>& crowd, double share, double least) {
  deep_.clear();
  for_touching([&](std::size_t lane) {
    const auto vector = static_cast<std::uint32_t>(lane / lanes);
    if ((deep_.empty() || deep_.back() != vector) && is_deep(crowd, lane, share, least))
      deep_.push_back(vector);
  });
  kernels_->sweep(view(crowd), deep_.data(), static_cast<std::uint32_t>(deep_.size()));
  return !deep_.empty();
}

template <class T>
bool CrowdEnds<T>::any_deep(const Crowd<T>& crowd, double share, double least) const {
  bool any = false;
  for_touching([&](std::size_t lane) { any = any || is_deep(crowd, lane, share, least); });
  return any;
}

template <class T>
bool CrowdEnds<T>::any_bounces() const {
  bool any = false;
  if (sees_bounces_)
    for_touching([&](std::size_t lane) { any = any || (ends_[lane].bounce > 0 && is_pushed(lane)); });
  return any;
}

template <class T>
void CrowdEnds<T>::bounce(Crowd<T>& crowd) {
  if (!sees_bounces_) return;
  for_touching([&](std::size_t lane) {
    End& end = ends_[lane];
    if (!(end.bounce > 0 && is_pushed(lane))) return;
    const Vec3 normal = vector(lane, fields::normal);
    const double leaves = dot(normal, crowd.velocity(place(lane)));
    const double kick = std::max(0.0, end.kick + field(lane, fields::mass) * (end.bounce - leaves));
    const double moves = field(lane, fields::moves);
    crowd.push_velocity(place(lane), moves * (kick - end.kick) * normal);
    end.kick = kick;
  });
}

template <class T>
void CrowdEnds<T>::end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h) {
  const auto all = static_cast<std::uint32_t>(touched_.size());
  const simd::EndView<T> own{nullptr, nullptr, fields_.data(), at_.data()};
  kernels_->keep(own, {0, all}, static_cast<T>(1 / (h * h)));
  if (!sees_bounces_) return;
  for (const Group& group : groups_)
    for (std::size_t lane = group.range.begin * lanes; lane < group.range.end * lanes; ++lane) {
      const End& end = ends_[lane];
      if (!touches(lane) || !cluster[end.island]->pulls.are_asked_for()) continue;
      if (!is_pushed(lane)) continue;
      const Vec3 normal = vector(lane, fields::normal);
      LinkagePulls& pulls = cluster[end.island]->pulls;
      const Vec3 impulse = 1 / h * vector(lane, fields::push) + end.kick * normal;
      if (pulls.counts) pulls.shapes[end.shape] += impulse;
      const double radius = cluster[end.island]->linkage->shape_of(end.shape).radius;
      pulls.touched.add(
          end.shape, TouchedPair::ground, group.number,
          {impulse, crowd.origin() + crowd.position(place(lane)) - radius * normal, normal, end.approach});
    }
}

template <class T>
void CrowdEnds<T>::keep(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) const {
  for (std::size_t lane = 0; lane < ends_.size(); ++lane) {
    const End& end = ends_[lane];
    const Vec3 force = vector(lane, fields::force);
    if (force == Vec3{} || !crowd.is_moving(end.island)) continue;
    cluster[end.island]->kept.push_back({end.key, force, {}});
  }
}

template <class T>
bool CrowdEnds<T>::any_push() const {
  return std::any_of(touching_.begin(), touching_.end(), [&](std::uint32_t v) {
    const T* const first = &fields_[(v * fields::count + fields::push) * std::size_t{lanes}];
    return std::any_of(first, first + std::size_t{3} * lanes, [](T push) { return push != 0; });
  });
}

template <class T>
std::size_t CrowdEnds<T>::count_pushes() const {
  std::size_t out = 0;
  for (const std::uint32_t v : touching_) {
    // Nothing pushes what does not touch.
    const T* const push = &fields_[(v * fields::count + fields::push) * std::size_t{lanes}];
    for (std::uint32_t k = 0; k < lanes; ++k)
      out += push[k] != 0 || push[lanes + k] != 0 || push[2 * lanes + k] != 0 ? 1 : 0;
  }
  return out;
}

template class CrowdEnds<float>;
template class CrowdEnds<double>;

}  // namespace plumb::detail
