// The ropes in plumb.
#include "faller.hpp"
#include "plumb/measures.hpp"
#include "plumb/world.hpp"

namespace plumb::bench {
namespace {

class PlumbRopes : public Faller {
 public:
  PlumbRopes(const Scene& scene, const Settings& settings) : scene_(scene), world_(scene, settings) {}

  void step() override { awake_ = world_.step(frame).awake_islands; }
  void copy_positions(std::span<Vec3> to) const override { world_.copy_positions(to); }
  double strain() const override {
    std::vector<Vec3> positions(world_.particle_count());
    world_.copy_positions(positions);
    return measure_stretch(scene_, positions).max;
  }
  std::uint32_t awake() const override { return awake_; }

 private:
  const Scene& scene_;
  World world_;
  std::uint32_t awake_ = 0;
};

Setting setting_of(std::string name, const Settings& settings) {
  return {"plumb", std::move(name),
          [=](const Scene& scene) { return std::make_unique<PlumbRopes>(scene, settings); }};
}

}  // namespace

Setting plumb_relaxed(std::uint32_t substeps, std::uint32_t sweeps, unsigned threads) {
  return setting_of(
      "relax " + std::to_string(substeps) + " x " + std::to_string(sweeps),
      {.method = Method::relax, .substeps = substeps, .stop = {.sweeps = sweeps}, .threads = threads});
}

Setting plumb_automatic(unsigned threads) {
  return setting_of("auto", {.threads = threads});
}

}  // namespace plumb::bench
