#include "plumb/embedding/drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "plumb/joints.hpp"
#include "plumb/loads.hpp"
#include "step/world_impl.hpp"

namespace plumb {
namespace {

using detail::Standing;

Color mixed(Color from, Color to, double share) {
  const auto one = [&](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + share * (b - a)));
  };
  return {one(from.red, to.red), one(from.green, to.green), one(from.blue, to.blue)};
}

void require_positive(double value, const char* what) {
  if (!(value > 0 && std::isfinite(value)))
    detail::refuse("drawing: ", what, " must be positive and finite, got ", value);
}

}  // namespace

/// Holds what is read of a world while it is drawn, and its room.
struct PLUMB_HIDDEN Drawing::Impl {
  /// This is the box around an island.
  struct Around {
    Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
    Vec3 high = -1.0 * low;
    bool is_asleep = false;

    void add(Vec3 p) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  };

  std::vector<Vec3> positions;
  std::vector<Standing> standings;        ///< by particle
  std::vector<std::uint64_t> frozen;      ///< islands, ascending
  std::map<std::uint64_t, Around> boxes;  ///< by island

  const detail::Step* step = nullptr;
  Canvas* canvas = nullptr;
  const DrawChoice* choice = nullptr;

  void read(const World& world);
  bool is_there(std::uint32_t particle) const { return step->population().particles.has(particle); }
  Vec3 place(const Point& point) const { return position_of(point, positions); }
  const Standing& standing(std::uint32_t a, std::uint32_t b) const {
    return standings[step->is_fixed(a) ? b : a];
  }
  Color shown(Color color, const Standing& of, bool may_freeze = false) const;
  Color shown(Color color, const Point& a, const Point& b, bool may_freeze = false) const;
  Color color_of_rod(const World& world, std::uint32_t rod) const;

  void draw_rods(const World& world);
  void draw_cords();
  void draw_joints();
  void draw_bodies(const World& world);
  void draw_anchors();
  void draw_grabs();
  void draw_contacts();
  void draw_bounds();
  void draw_box(const Around& box, Color color) const;
};

void Drawing::Impl::read(const World& world) {
  positions.resize(world.particle_count());
  world.copy_positions(positions);
  standings.resize(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    standings[i] = is_there(i) ? step->standing(i) : Standing{};
  frozen.clear();
  for (const Problem& problem : world.problems(std::numeric_limits<double>::infinity()))
    if (problem.kind == Problem::Kind::frozen) frozen.push_back(standings[problem.particle].island);
  std::sort(frozen.begin(), frozen.end());
}

/// Calls f for those of a list that the world has.
template <class Item, class F>
void for_those(const std::vector<Item>& list, const detail::Numbers& numbers, F&& f) {
  for (std::uint32_t i = 0; i < list.size(); ++i)
    if (numbers.has(i)) f(list[i]);
}

Color Drawing::Impl::shown(Color color, const Standing& of, bool may_freeze) const {
  if (may_freeze && std::binary_search(frozen.begin(), frozen.end(), of.island)) return choice->colors.frozen;
  return of.is_asleep && choice->asleep ? mixed(color, choice->colors.asleep, 0.75) : color;
}

/// Goes by the first movable particle of two places.
Color Drawing::Impl::shown(Color color, const Point& a, const Point& b, bool may_freeze) const {
  for (const Point* const point : {&a, &b})
    for (std::size_t k = 0; k < 4; ++k)
      if (point->weights[k] != 0 && !step->is_fixed(point->particles[k]))
        return shown(color, standings[point->particles[k]], may_freeze);
  return color;
}

Color Drawing::Impl::color_of_rod(const World& world, std::uint32_t rod) const {
  const Palette& colors = choice->colors;
  const Rod& of = step->scene().rods[rod];
  const Standing& where = standing(of.a, of.b);
  double bears = 0;
  if (choice->tone == RodTone::tension) {
    bears = world.tension(rod);
  } else if (choice->tone == RodTone::strain) {
    const double length = step->length(rod);
    bears = (norm(positions[of.b] - positions[of.a]) - length) / length;
  }
  // A cable that is slack bears nothing, and neither does what is not known yet.
  if (!std::isfinite(bears) || (of.law.one_sided && bears < 0)) bears = 0;
  const double share = std::min(std::abs(bears) / choice->full, 1.0);
  return shown(mixed(colors.rod, bears < 0 ? colors.pressed : colors.stretched, share), where, true);
}

void Drawing::Impl::draw_rods(const World& world) {
  const std::vector<Rod>& rods = step->scene().rods;
  for (std::uint32_t i = 0; i < rods.size(); ++i) {
    if (!step->population().rods.has(i) || world.is_broken(i)) continue;
    const Vec3 a = positions[rods[i].a], b = positions[rods[i].b];
    canvas->line(a, b, color_of_rod(world, i));
    if (choice->numbers) canvas->text(0.5 * (a + b), std::to_string(i), choice->colors.body);
  }
}

void Drawing::Impl::draw_cords() {
  const Scene& scene = step->scene();
  for (std::uint32_t i = 0; i < scene.tackles.size(); ++i) {
    if (!step->population().tackles.has(i)) continue;
    const std::vector<std::uint32_t>& over = scene.tackles[i].particles;
    const auto movable = std::find_if(over.begin(), over.end(), [&](auto p) { return !step->is_fixed(p); });
    const Color color =
        movable == over.end() ? choice->colors.cord : shown(choice->colors.cord, standings[*movable], true);
    for (std::size_t k = 1; k < over.size(); ++k)
      canvas->line(positions[over[k - 1]], positions[over[k]], color);
  }
  for_those(scene.springs, step->population().springs, [&](const Spring& spring) {
    canvas->line(place(spring.a), place(spring.b), shown(choice->colors.cord, spring.a, spring.b, true));
  });
}

void Drawing::Impl::draw_joints() {
  const Scene& scene = step->scene();
  const Color color = choice->colors.joint;
  const detail::Population& all = step->population();
  for_those(scene.pins, all.pins,
            [&](const Pin& pin) { canvas->point(place(pin.a), shown(color, pin.a, pin.b)); });
  const auto draw = [&](const Direction& way) {
    canvas->line(place(way.from), place(way.to), shown(color, way.from, way.to));
  };
  for_those(scene.alignments, all.alignments, [&](const Alignment& alignment) {
    draw(alignment.u);
    draw(alignment.v);
  });
  for_those(scene.torsions, all.torsions, [&](const Torsion& torsion) { draw(torsion.axis); });
}

void Drawing::Impl::draw_bodies(const World& world) {
  const Scene& scene = step->scene();
  for (std::uint32_t i = 0; i < world.body_count(); ++i) {
    const auto& particles = scene.bodies[i].particles;
    if (!step->population().bodies.has(i)) continue;
    const Point all{particles, {1, 1, 1, 1}};
    const Color color = shown(choice->colors.body, all, all);
    const Pose pose = world.pose(i);
    for (const Vec3& axis : axes_of(pose.orientation))
      canvas->line(pose.position, pose.position + choice->length * axis, color);
    if (choice->numbers) canvas->text(pose.position, std::to_string(i), color);
  }
}

void Drawing::Impl::draw_anchors() {
  for (std::uint32_t i = 0; i < positions.size(); ++i)
    if (is_there(i) && step->is_fixed(i)) canvas->point(positions[i], choice->colors.anchor);
}

void Drawing::Impl::draw_grabs() {
  const detail::Grabs& grabs = step->grabs();
  for (std::uint32_t i = 0; i < grabs.numbers().count(); ++i) {
    if (!grabs.numbers().has(i)) continue;
    canvas->line(place(grabs.place(i)), grabs.target(i), choice->colors.grab);
    canvas->point(grabs.target(i), choice->colors.grab);
  }
}

void Drawing::Impl::draw_contacts() {
  for (const Contact& contact : step->contacts()) {
    if (contact.phase == ContactPhase::ended) continue;
    canvas->point(contact.point, choice->colors.contact);
    canvas->line(contact.point, contact.point + choice->length * contact.normal, choice->colors.contact);
  }
}

void Drawing::Impl::draw_box(const Around& box, Color color) const {
  const auto corner = [&](unsigned i) {
    return Vec3{i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                i & 4 ? box.high.z : box.low.z};
  };
  for (unsigned from = 0; from < 8; ++from)
    for (unsigned axis = 1; axis < 8; axis *= 2)
      if ((from & axis) == 0) canvas->line(corner(from), corner(from | axis), color);
}

void Drawing::Impl::draw_bounds() {
  boxes.clear();
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    if (!is_there(i) || step->is_fixed(i)) continue;
    Around& box = boxes[standings[i].island];
    box.add(positions[i]);
    box.is_asleep = standings[i].is_asleep;
  }
  for (const auto& [island, box] : boxes)
    draw_box(box, shown(choice->colors.bounds, {island, box.is_asleep}));
}

Canvas::~Canvas() = default;

Drawing::Drawing() : impl_(std::make_unique<Impl>()) {}
Drawing::~Drawing() = default;
Drawing::Drawing(Drawing&&) noexcept = default;
Drawing& Drawing::operator=(Drawing&&) noexcept = default;

void Drawing::draw(const World& world, Canvas& canvas, const DrawChoice& choice) {
  require_positive(choice.full, "full");
  require_positive(choice.length, "length");
  if (choice.rods && choice.tone == RodTone::tension) world.impl_->require_tensions();
  Impl& is = *impl_;
  is.step = &*world.impl_->step;
  is.canvas = &canvas;
  is.choice = &choice;
  is.read(world);
  if (choice.rods) {
    is.draw_rods(world);
    is.draw_cords();
  }
  if (choice.joints) is.draw_joints();
  if (choice.bodies) is.draw_bodies(world);
  if (choice.anchors) is.draw_anchors();
  if (choice.grabs) is.draw_grabs();
  if (choice.contacts && world.impl_->contacts) is.draw_contacts();
  if (choice.bounds) is.draw_bounds();
}

}  // namespace plumb
