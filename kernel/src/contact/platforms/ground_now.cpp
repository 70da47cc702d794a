#include "contact/platforms/ground_now.hpp"

namespace plumb::detail {

template <class Ground>
void GroundNow::pose(std::span<const Ground> ground, Array<Ground>& there, Array<GroundRate>& rates) const {
  there.assign(ground.begin(), ground.end());
  rates.resize(ground.size());
  for (std::size_t i = 0; i < ground.size(); ++i) {
    const GroundMotion& motion = ground[i].motion;
    rates[i] = {.belt = motion.belt};
    if (!motion.platform) continue;
    const PlatformPose& pose = poses_[*motion.platform];
    there[i] = posed(ground[i], pose);
    rates[i] = pose.rate;
    rates[i].belt = pose.direction(motion.belt);
  }
}

void GroundNow::find(const Surroundings& surroundings, double time) {
  planes_ = surroundings.planes;
  boxes_ = surroundings.boxes;
  shapes_ = surroundings.anchored.shapes();
  if (!surroundings.may_move()) return;
  poses_.resize(surroundings.platforms.count());
  for (std::uint32_t i = 0; i < poses_.size(); ++i) poses_[i] = surroundings.platforms.at(i, time);
  pose(planes_, moved_planes_, plane_rates_);
  pose(boxes_, moved_boxes_, box_rates_);
  planes_ = moved_planes_;
  boxes_ = moved_boxes_;
  cube_ = &surroundings.cube;
  find_corners();
  surroundings.anchored.find_positions(time, anchors_);
  segments_.resize(shapes_.size());
  segment_rates_.resize(shapes_.size());
  ends_.clear();
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    segments_[i] = surroundings.anchored.segment(i, anchors_);
    segment_rates_[i] = surroundings.anchored.rate(i, anchors_);
    ends_.insert(ends_.end(), {segments_[i].p, segments_[i].q});
  }
}

void GroundNow::find_corners() {
  const std::size_t corners = cube_->vertices().size(), faces = cube_->parts().faces();
  corners_.resize(boxes_.size() * corners);
  normals_.resize(boxes_.size() * faces);
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const Surroundings::Solid& box = boxes_[i];
    if (!box.motion.platform) continue;
    for (std::size_t k = 0; k < corners; ++k) {
      const Vec3 v = cube_->vertices()[k];
      corners_[i * corners + k] =
          box.center + box.frame.to_space({v.x * box.half.x, v.y * box.half.y, v.z * box.half.z});
    }
    for (std::size_t k = 0; k < faces; ++k)
      normals_[i * faces + k] = box.frame.to_space(cube_->shape(0).normals[k]);
  }
}

double fastest(const GroundRate* rate, const Bounds& bounds, double dt) {
  return rate == nullptr ? 0 : fastest(*rate, bounds, dt);
}

}  // namespace plumb::detail
