#include "contest/baseline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "plumb/layouts/coloring.hpp"
#include "threads/flush_denormals.hpp"

namespace plumb::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

template <class T>
class Baseline final : public Stepper {
 public:
  Baseline(const Scene& scene, const std::vector<std::uint32_t>& order) {
    const double h = frame_length;
    fall_ = vector(h * h * scene.gravity, 0);
    const std::vector<double> masses = lumped_masses(scene);
    for (std::size_t i = 0; i < scene.particles.size(); ++i) {
      const Vec3 x = scene.particles[i].position;
      const double w = 1 / masses[i];
      now_.push_back(vector(x, w));
      // From rest, the first step must be half of g h^2.
      before_.push_back(vector(w > 0 ? x + 0.5 * h * h * scene.gravity : x, w));
    }
    for (const std::uint32_t i : order)
      links_.push_back({scene.rods[i].a, scene.rods[i].b, static_cast<T>(rod_length(scene, i))});
  }

  double run(std::uint32_t steps, std::uint32_t sweeps) override {
    const detail::FlushDenormals flush;
    const std::uint32_t made = std::min(sweeps, most_sweeps_);
    double predicting = 0, sweeping = 0;
    for (std::uint32_t step = 0; step < steps; ++step) {
      const auto start = Clock::now();
      predict();
      const auto predicted = Clock::now();
      for (std::uint32_t i = 0; i < made; ++i) sweep();
      sweeping += seconds_since(predicted);
      predicting += std::chrono::duration<double>(predicted - start).count();
    }
    return (predicting + sweeping * sweeps / made) / steps;
  }

  void extrapolate_beyond(std::uint32_t most_sweeps) override { most_sweeps_ = most_sweeps; }

  Stretch stretch(const Scene& scene) const override {
    std::vector<Vec3> positions;
    for (const Vector& p : now_) positions.push_back({p.x, p.y, p.z});
    return measure_stretch(scene, positions);
  }

 private:
  struct Vector {
    T x, y, z, w;  // w: inverse mass
  };
  struct Link {
    std::uint32_t a, b;
    T length;
  };

  static Vector vector(Vec3 v, double w) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z), static_cast<T>(w)};
  }

  /// Predicts by position Verlet (thesis eq. 4.5).
  void predict() {
    for (std::size_t i = 0; i < now_.size(); ++i) {
      Vector& x = now_[i];
      if (x.w == 0) continue;
      const Vector last = before_[i];
      before_[i] = x;
      x.x += x.x - last.x + fall_.x;
      x.y += x.y - last.y + fall_.y;
      x.z += x.z - last.z + fall_.z;
    }
  }

  /// Corrects every rod by thesis eq. 4.7.
  void sweep() {
    for (const Link& link : links_) {
      Vector& a = now_[link.a];
      Vector& b = now_[link.b];
      const T dx = b.x - a.x, dy = b.y - a.y, dz = b.z - a.z;
      const T length = std::sqrt(dx * dx + dy * dy + dz * dz);
      const T move = (length - link.length) / (length * (a.w + b.w));
      const T move_a = move * a.w, move_b = move * b.w;
      a.x += move_a * dx;
      a.y += move_a * dy;
      a.z += move_a * dz;
      b.x -= move_b * dx;
      b.y -= move_b * dy;
      b.z -= move_b * dz;
    }
  }

  std::uint32_t most_sweeps_ = std::numeric_limits<std::uint32_t>::max();
  Vector fall_;
  std::vector<Vector> now_, before_;
  std::vector<Link> links_;
};

}  // namespace

std::unique_ptr<Stepper> make_baseline(const Scene& scene, Precision precision,
                                       const std::vector<std::uint32_t>& order) {
  if (precision == Precision::single) return std::make_unique<Baseline<float>>(scene, order);
  return std::make_unique<Baseline<double>>(scene, order);
}

std::vector<std::uint32_t> natural_order(const Scene& scene) {
  std::vector<std::uint32_t> order(scene.rods.size());
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

std::vector<std::uint32_t> colored_order(const Scene& scene) {
  std::vector<layouts::Edge> edges;
  for (const Rod& rod : scene.rods) edges.push_back({rod.a, rod.b});
  std::vector<std::uint8_t> movable;
  for (const Particle& particle : scene.particles) movable.push_back(!particle.fixed);
  const layouts::Coloring coloring =
      layouts::color_edges({static_cast<std::uint32_t>(movable.size()), edges, movable});
  std::vector<std::uint32_t> order = natural_order(scene);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t l, std::uint32_t r) {
    return coloring.color_of_edge[l] < coloring.color_of_edge[r];
  });
  return order;
}

}  // namespace plumb::bench
