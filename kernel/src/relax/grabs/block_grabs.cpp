#include "relax/grabs/block_grabs.hpp"

#include <algorithm>

namespace plumb::detail {
namespace {

/// Calls f(grab) for those of particles in positions [q0, q1) that move.
template <class T, class F>
void for_grabs(std::span<BlockGrab> all, const Block<T>& block, std::uint32_t q0, std::uint32_t q1, F&& f) {
  for (BlockGrab& grab : all)
    if (const std::uint32_t q = block.position_of(grab.slot);
        q >= q0 && q < q1 && !block.is_frozen(grab.slot))
      f(grab);
}

}  // namespace

template <class T>
void BlockGrabs::begin(Block<T>& block, Gradient gradient, const T* last, std::uint32_t q0,
                       std::uint32_t q1) const {
  for_grabs(all, block, q0, q1, [&](BlockGrab& grab) {
    const Vec3 before = decay * block.read(last, grab.slot);
    grab.substep = GrabSubstep::begin(grab, gradient, grab.mass, block.read(block.x(), grab.slot), before, h);
    const double inverse_mass = block.grabbed_inverse_mass(grab.slot);
    const Vec3 others =
        grab.is_first ? grab.mass * inverse_mass * grab.kick : block.read(block.kick(), grab.slot);
    block.write(block.kick(), grab.slot, others + (inverse_mass * kick) * grab.substep.force);
  });
}

template <class T>
void BlockGrabs::see(const Block<T>& block, const T* own, std::uint32_t q0, std::uint32_t q1) const {
  for_grabs(all, block, q0, q1, [&](BlockGrab& grab) { grab.moved = block.read(own, grab.slot); });
}

template <class T>
void BlockGrabs::end(Block<T>& block, Gradient gradient, bool is_guarded, T* own, std::uint32_t q0,
                     std::uint32_t q1) const {
  for_grabs(all, block, q0, q1, [&](BlockGrab& grab) {
    Vec3 stop{};
    if (gradient == Gradient::mid) {
      const Vec3 swung = decay * (2 * grab.moved - grab.substep.before), mean = decay * grab.moved;
      const Vec3 found = is_guarded ? mean : block.read(own, grab.slot);
      const Vec3 left = found + grab.substep.velocity_change(found - mean);
      block.write(own, grab.slot, left);
      stop = (grab.mass / h) * (left - swung);
    }
    grab.substep.end(h, kick, grab.moved, stop, grab);
  });
}

template void BlockGrabs::begin(Block<float>&, Gradient, const float*, std::uint32_t, std::uint32_t) const;
template void BlockGrabs::see(const Block<float>&, const float*, std::uint32_t, std::uint32_t) const;
template void BlockGrabs::end(Block<float>&, Gradient, bool, float*, std::uint32_t, std::uint32_t) const;
template void BlockGrabs::begin(Block<double>&, Gradient, const double*, std::uint32_t, std::uint32_t) const;
template void BlockGrabs::see(const Block<double>&, const double*, std::uint32_t, std::uint32_t) const;
template void BlockGrabs::end(Block<double>&, Gradient, bool, double*, std::uint32_t, std::uint32_t) const;

}  // namespace plumb::detail
