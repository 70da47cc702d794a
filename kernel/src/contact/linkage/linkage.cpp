#include "contact/linkage/linkage.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "contact/levers/shape_maker.hpp"
#include "plumb/layouts/coloring.hpp"
#include "plumb/layouts/shapes.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb::detail {
namespace {

/// The matrix gets this share of a constraint's own pivot on its diagonal. Constraints stay exact all the
/// same, since violations are corrected again.
constexpr double tiny = 1e-11;
/// Redundant constraints get this share instead, and velocities are corrected again, too. What forbids a
/// motion twice has a pivot of this size alone, whose rounding is lost in smaller ones.
constexpr double tiny_if_redundant = 1e-8;
/// A pivot that is smaller by this factor than its constraint's own is that of a redundant one. Masses that
/// differ by 1e6 make 1e6 of it.
constexpr double redundant = 1e8;
/// Particles count as free if no coupling takes more than the rest of this share of their masses. A slender
/// rod alone leaves half.
constexpr double least_free_mass = 0.1;

Array<Vec3> positions_of(const Scene& scene) {
  Array<Vec3> out;
  for (const Particle& particle : scene.particles) out.push_back(particle.position);
  return out;
}

}  // namespace

void Combination::add(std::uint32_t particle, double weight) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (terms[i].particle != particle) continue;
    terms[i].weight += weight;
    return;
  }
  terms[count++] = {particle, weight};
}

Combination combination(const Point& point) {
  Combination out;
  for (std::size_t i = 0; i < 4; ++i)
    if (point.weights[i] != 0) out.add(point.particles[i], point.weights[i]);
  return out;
}

Combination difference(const Point& to, const Point& from) {
  Combination out = combination(to);
  for (std::size_t i = 0; i < 4; ++i)
    if (from.weights[i] != 0) out.add(from.particles[i], -from.weights[i]);
  return out;
}

Linkage::Linkage(const Scene& part, Isa isa, Use use, std::span<const Combination> grabs)
    : particles_(static_cast<std::uint32_t>(part.particles.size())),
      movable_(static_cast<std::uint32_t>(std::count_if(part.particles.begin(), part.particles.end(),
                                                        [](const Particle& each) { return !each.fixed; }))),
      gravity_(part.gravity),
      drag_(part.drag),
      joint_drag_(part.joint_drag) {
  const Array<Vec3> x = positions_of(part);
  weigh(part, use);
  std::uint32_t row = 3 * movable_;
  add_rods(part, row);
  add_joints(part, x, row);
  constraints_ = row - 3 * movable_;
  find_flat_rods(part);
  add_angles(part);
  add_elastics(part);
  first_grab_ = elastics_.size();
  targets_ = grabs.size();
  for (const Combination& apart : grabs)
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      add_elastic({.kind = Elastic::Kind::along, .sums = {apart}, .axis = axis}, {});
  add_shapes(part, x);
  add_hulls(part, x);
  has_air_ = !airs_.empty() || drag_ != 0 || joint_drag_ != 0;
  if (size_ == 0) size_ = 1;
  for (DotRow& each : dots_) each.over = 1 / (size_ * size_);
  if (use == Use::relaxed || flat_rods() == 0) color_rods();
  const auto any_rod = [&](auto&& is) { return std::any_of(part.rods.begin(), part.rods.end(), is); };
  const bool is_simple = part.bodies.empty() && airs_.empty();
  relaxes_ = is_simple && any_rod([](const Rod& rod) { return !rod.law.is_elastic() && !rod.law.one_sided; });
  crowds_ = is_simple && (movable_ == 1 || any_rod([](const Rod& rod) { return !rod.law.is_elastic(); }));
  find_loose();
  if (use == Use::relaxed) return;
  plan(isa);
  hold_constraints(x);
  find_taut_rods(part);
}

void Linkage::color_rods() {
  Array<layouts::Edge> edges;
  for (const RodRow& rod : rods_) edges.push_back({rod.a, rod.b});
  Array<std::uint8_t> movable(particles_, 0);
  std::fill_n(movable.begin(), movable_, 1);
  const layouts::Graph graph{particles_, edges, movable};
  const auto colored = [&](std::size_t i) {
    return ColoredRods::Rod{rods_[i].a, rods_[i].b, rods_[i].number, 1 / rods_[i].over2};
  };
  const layouts::Coloring coloring = layouts::color_edges(graph);
  for (std::uint32_t color = 0; color < coloring.colors; ++color) {
    for (std::size_t i = 0; i < rods_.size(); ++i)
      if (coloring.color_of_edge[i] == color) colored_.rods.push_back(colored(i));
    colored_.begin.push_back(static_cast<std::uint32_t>(colored_.rods.size()));
  }
  layouts::ShapeInfo shape = layouts::detect_shape(graph);
  if (shape.shape != layouts::Shape::grid) return;
  colored_.grid = {shape.width, shape.height, std::move(shape.vertex_order), {}};
  for (const std::uint32_t edge : shape.edge_order) colored_.grid.rods.push_back(colored(edge));
}

void Linkage::add_rods(const Scene& part, std::uint32_t& row) {
  const auto rigid = static_cast<std::size_t>(
      std::count_if(part.rods.begin(), part.rods.end(), [](const Rod& rod) { return rod.law.is_rigid(); }));
  rods_.reserve(rigid);
  giving_rods_.reserve(part.rods.size() - rigid);
  for (std::size_t i = 0; i < part.rods.size(); ++i) {
    const Rod& rod = part.rods[i];
    const double length = rod_length(part, i);
    size_ = std::max(size_, length);
    const double over2 = 1 / (length * length);
    const auto number = static_cast<std::uint32_t>(i);
    if (rod.law.is_rigid())
      rods_.push_back({rod.a, rod.b, over2, number, row++, {}});
    else
      giving_rods_.push_back({rod.a, rod.b, over2, number, none, {}});
    if (rod.linear_drag != 0 || rod.orthogonal_drag != 0)
      airs_.push_back({rod.a, rod.b, rod_mass(part, i, MassModel::consistent), rod.linear_drag,
                       rod.orthogonal_drag, 1 / length});
  }
}

void Linkage::add_joints(const Scene& part, std::span<const Vec3> x, std::uint32_t& row) {
  for (const Alignment& alignment : part.alignments) {
    DotRow dot_row{.u = difference(alignment.u.to, alignment.u.from),
                   .v = difference(alignment.v.to, alignment.v.from),
                   .value = 0,
                   .over = 1,
                   .row = row++,
                   .places = {},
                   .touched = {}};
    dot_row.value = alignment.value.value_or(dot(dot_row.u.of(x), dot_row.v.of(x)));
    dots_.push_back(dot_row);
  }
  for (const Pin& pin : part.pins) {
    const Combination apart = are_one_place(pin.a, pin.b) ? Combination{} : difference(pin.a, pin.b);
    pins_.push_back({apart, {row, row + 1, row + 2}, {}});
    row += 3;
  }
}

void Linkage::add_angles(const Scene& part) {
  for (const AngleControl& angle : part.angles) {
    angles_.push_back({difference(angle.u.to, angle.u.from), difference(angle.v.to, angle.v.from)});
    angle_rules_.push_back({angle.lower, angle.upper, angle.friction});
  }
}

void Linkage::add_filter(const Filter& filter) {
  if (std::find(filters_.begin(), filters_.end(), filter) == filters_.end()) filters_.push_back(filter);
}

void Linkage::add_shapes(const Scene& part, std::span<const Vec3> x) {
  std::map<std::uint32_t, Array<std::size_t>> balls_at;
  const ShapeMaker maker(part);
  neighbors_ = Neighbors(part);
  shapes_.reserve(part.capsules.size());
  balls_.reserve(part.capsules.size() + 1);  // those of a line, and of most that has shapes
  for (const Capsule& capsule : part.capsules) {
    const Shape& shape = shapes_.emplace_back(maker.make(capsule, places_));
    add_filter(shape.filter);
    const auto number = static_cast<std::uint32_t>(shapes_.size() - 1);
    size_ = std::max({size_, 2 * capsule.radius, norm(shape.a.of(x) - shape.b.of(x))});
    for (const Terms end : {shape.a, shape.b}) {
      const Ball ball{end, capsule.radius, capsule.surface, number, capsule.filter};
      if (end.size() > 1) {
        balls_.push_back(ball);
        continue;
      }
      Array<std::size_t>& there = balls_at[end[0].particle];
      const auto same = std::find_if(there.begin(), there.end(),
                                     [&](std::size_t i) { return balls_[i].filter == ball.filter; });
      if (same == there.end()) {
        there.push_back(balls_.size());
        balls_.push_back(ball);
      } else if (balls_[*same].radius < ball.radius) {
        balls_[*same] = ball;
      }
    }
  }
}

void Linkage::weigh(const Scene& part, Use use) {
  masses_.assign(movable_, 0);
  weights_.assign(movable_, 0);
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> between;
  const auto add = [&](std::uint32_t i, std::uint32_t j, double mass) {
    if (i < movable_) weights_[i] += mass;
    if (i < movable_ && j == i) masses_[i] += mass;
    if (i < j && j < movable_) between[{i, j}] += mass;
  };
  for (std::uint32_t i = 0; i < movable_; ++i) add(i, i, part.particles[i].mass);
  for (std::size_t i = 0; i < part.rods.size(); ++i) {
    const Rod& rod = part.rods[i];
    const RodMass mass = rod_mass(part, i, MassModel::consistent);
    add(rod.a, rod.a, mass.aa);
    add(rod.a, rod.b, mass.ab);
    add(rod.b, rod.a, mass.ab);
    add(rod.b, rod.b, mass.bb);
  }
  for (std::size_t i = 0; i < part.bodies.size(); ++i) {
    const auto mass = body_mass(part, i);
    const auto& particles = part.bodies[i].particles;
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) add(particles[j], particles[k], mass[j][k]);
    BodyShape& shape = bodies_.emplace_back(BodyShape{particles, {}});
    for (std::size_t j = 0; j < 4; ++j) shape.places[j] = part.particles[particles[j]].position;
  }
  nominal_masses_ = masses_;
  weigh_flat_bodies(part, use);
  for (const auto& [pair, mass] : between)
    if (mass != 0) couplings_.push_back({pair.first, pair.second, mass});
  free_masses_ = masses_;
  for (const Coupling& each : couplings_)
    for (const std::uint32_t particle : {each.a, each.b}) free_masses_[particle] -= std::abs(each.mass);
  has_free_masses_ = true;
  for (std::uint32_t i = 0; i < movable_; ++i)
    has_free_masses_ = has_free_masses_ && free_masses_[i] > least_free_mass * masses_[i];
  for (const double weight : weights_) mass_ += weight;
}

/// Ground holds a shape at any place between its ends.
void Linkage::couple_shapes(Array<std::pair<std::uint32_t, std::uint32_t>>& pairs) const {
  for (const Shape& shape : shapes_) {
    const Array<std::uint32_t> movable = movable_of(std::array<Combination, 2>{shape.a, shape.b});
    for (std::size_t i = 0; i < movable.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) pairs.emplace_back(3 * movable[i], 3 * movable[j]);
  }
  for (const HullShape& hull : hulls_)
    for (const std::uint32_t i : hull.particles)
      for (const std::uint32_t j : hull.particles)
        if (j < i && i < movable_) pairs.emplace_back(3 * i, 3 * j);
  for (const FlatRod& rod : flat_rods_)
    if (rod.a < movable_ && rod.b < movable_) pairs.emplace_back(3 * rod.a, 3 * rod.b);
  // Beside bodies and what touches, chains without shapes swing across themselves, too. Arms of mechanisms
  // are held across themselves.
  if ((bodies_.empty() && shapes_.empty() && hulls_.empty()) || !dots_.empty()) return;
  Array<std::uint8_t> in_body(movable_, 0);
  for (const BodyShape& body : bodies_)
    for (const std::uint32_t each : body.particles)
      if (each < movable_) in_body[each] = 1;
  const auto couple = [&](std::uint32_t a, std::uint32_t b) {
    if (a < movable_ && b < movable_ && !in_body[a] && !in_body[b]) pairs.emplace_back(3 * a, 3 * b);
  };
  for (const RodRow& rod : rods_) couple(rod.a, rod.b);
  for (std::size_t i = 0; i < elastics_.size(); ++i)
    if (is_rigid_rod(i))
      couple(elastics_[i].sums[0].terms[0].particle, elastics_[i].sums[0].terms[1].particle);
}

/// Returns whether an elastic is a rod between two particles that is rigid until it breaks or hangs slack.
bool Linkage::is_rigid_rod(std::size_t elastic) const {
  const Elastic& each = elastics_[elastic];
  const Combination& apart = each.sums[0];
  return each.kind == Elastic::Kind::distance && apart.count == 2 && std::abs(apart.terms[0].weight) == 1 &&
         std::abs(apart.terms[1].weight) == 1 && std::isinf(elastic_laws_[elastic].stiffness);
}

void Linkage::plan(Isa isa) {
  Array<std::pair<std::uint32_t, std::uint32_t>> pairs;
  const auto couple = [&](std::uint32_t particle, std::uint32_t row) {
    if (particle >= movable_) return;
    for (std::uint32_t axis = 0; axis < 3; ++axis) pairs.emplace_back(3 * particle + axis, row);
  };
  for (const Coupling& c : couplings_)
    for (std::uint32_t axis = 0; axis < 3; ++axis) pairs.emplace_back(3 * c.a + axis, 3 * c.b + axis);
  for (const RodRow& rod : rods_) {
    couple(rod.a, rod.row);
    couple(rod.b, rod.row);
  }
  for (DotRow& each : dots_) {
    each.touched = movable_of(std::array{each.u, each.v});
    for (const std::uint32_t particle : each.touched) couple(particle, each.row);
  }
  for (const Elastic& each : elastics_)
    for (const std::uint32_t particle : each.touched) couple(particle, each.row);
  for (const PinRow& pin : pins_)
    for (std::uint32_t i = 0; i < pin.sum.count; ++i)
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        if (pin.sum.terms[i].particle < movable_)
          pairs.emplace_back(3 * pin.sum.terms[i].particle + axis, pin.rows[axis]);
  couple_shapes(pairs);
  plan_ = KktPlan(movable_, constraints_ + static_cast<std::uint32_t>(elastics_.size()), pairs, isa);
  for (std::uint32_t i = 0; i < movable_; ++i) slots_.push_back(plan_.position(3 * i));

  for (Coupling& c : couplings_) c.place = plan_.place(3 * c.a, 3 * c.b);
  softs_.assign(constraints_, 0.0);
  place_constraints();
}

void Linkage::find_loose() {
  is_held_.assign(particles_, 0);
  for (const RodRow& rod : rods_) is_held_[rod.a] = is_held_[rod.b] = 1;
  for (const Coupling& each : couplings_) is_held_[each.a] = is_held_[each.b] = 1;
  for (const DotRow& each : dots_)
    for (const std::uint32_t particle : movable_of(std::array{each.u, each.v})) is_held_[particle] = 1;
  for (const PinRow& pin : pins_)
    for (std::uint32_t i = 0; i < pin.sum.count; ++i) is_held_[pin.sum.terms[i].particle] = 1;
  for (Elastic& each : elastics_)
    each.is_loose = std::none_of(each.touched.begin(), each.touched.end(),
                                 [&](std::uint32_t particle) { return is_held(particle); });
}

Array<double> Linkage::soften(double share, std::span<double> values) const {
  Array<double> pivots(constraints_, 1 / mass_);
  const auto add = [&](std::uint32_t row, std::span<const std::uint32_t> places,
                       std::span<const std::uint32_t> particles) {
    double sum = 0;
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i] != none) sum += values[places[i]] * values[places[i]] / nominal_masses_[particles[i / 3]];
    pivots[row - 3 * movable_] = std::max(sum, 1e-6 / (mass_ * size_ * size_));
  };
  for (const RodRow& rod : rods_) add(rod.row, rod.places, std::array{rod.a, rod.b});
  for (const DotRow& each : dots_) add(each.row, each.places, each.touched);
  for (std::uint32_t c = 0; c < constraints_; ++c) {
    const std::uint32_t row = 3 * movable_ + c;
    values[plan_.place(row, row)] = -share * pivots[c];
  }
  return pivots;
}

bool Linkage::is_redundant_at(std::span<const Vec3> x) const {
  Array<simd::Block> matrix(plan_.blocks());
  assemble(x, matrix);
  const Array<double> pivots = soften(tiny, numbers(matrix));
  plan_.factor(matrix);
  for (std::uint32_t c = 0; c < constraints_; ++c) {
    // The factors keep inverse pivots in the last column of a block.
    const std::uint32_t at = plan_.position(3 * movable_ + c);
    const double inverse = matrix[at / 4].of[12 + at % 4];
    if (!(std::abs(inverse) * pivots[c] < redundant)) return true;
  }
  return false;
}

void Linkage::hold_constraints(std::span<const Vec3> x) {
  is_redundant_ = is_redundant_at(x);
  const double share = is_redundant_ ? tiny_if_redundant : tiny;
  Array<simd::Block> matrix(plan_.blocks());
  assemble(x, matrix);
  const Array<double> pivots = soften(share, numbers(matrix));
  for (std::uint32_t c = 0; c < constraints_; ++c) softs_[c] = share * pivots[c];
  const auto add = [&](std::uint32_t row, double square) {
    softness_ += share * square * pivots[row - 3 * movable_];
  };
  for (const RodRow& rod : rods_) add(rod.row, 1 / rod.over2);
  for (const DotRow& each : dots_) add(each.row, size_ * size_);
  for (const PinRow& pin : pins_) add(pin.rows[0], 1);
}

void Linkage::place_constraints() {
  for (RodRow& rod : rods_)
    for (std::uint32_t end = 0; end < 2; ++end)
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t particle = end == 0 ? rod.a : rod.b;
        rod.places[3 * end + axis] = particle < movable_ ? plan_.place(3 * particle + axis, rod.row) : none;
      }
  for (DotRow& each : dots_)
    for (const std::uint32_t particle : each.touched)
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        each.places.push_back(plan_.place(3 * particle + axis, each.row));
  for (Elastic& each : elastics_)
    for (const std::uint32_t particle : each.touched)
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        each.places.push_back(plan_.place(3 * particle + axis, each.row));
  for (PinRow& pin : pins_)
    for (std::uint32_t i = 0; i < pin.sum.count; ++i) {
      const std::uint32_t particle = pin.sum.terms[i].particle;
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        pin.places.push_back(particle < movable_ ? plan_.place(3 * particle + axis, pin.rows[axis]) : none);
    }
}

double Linkage::thinness() const {
  double least = size_;
  for (const Shape& shape : shapes_) least = std::min(least, shape.radius);
  for (const HullShape& hull : hulls_) least = std::min(least, hull.half_width);
  return std::max(least, 0.01 * size_);
}

}  // namespace plumb::detail
