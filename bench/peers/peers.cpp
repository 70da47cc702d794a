#include "peer.hpp"

namespace plumb::bench {

PeerPath halving_path(const std::string& label, const std::string& suffix,
                      std::function<std::unique_ptr<Peer>(const Model&, std::uint32_t)> make) {
  const auto steps = [](std::uint32_t level) { return std::uint32_t{1} << level; };
  return {.name =
              [=](std::uint32_t level) {
                return label + " " + std::to_string(frames_per_second) + "x" + std::to_string(steps(level)) +
                       suffix;
              },
          .make = [=](const Model& model, std::uint32_t level) { return make(model, steps(level)); }};
}

std::vector<PeerFamily> all_peers() {
  std::vector<PeerFamily> out;
#ifdef PLUMB_PEER_BULLET
  out.push_back(bullet_soft_family());
  out.push_back(bullet_multibody_family());
#endif
#ifdef PLUMB_PEER_MUJOCO
  out.push_back(mujoco_family());
#endif
#ifdef PLUMB_PEER_SIMBODY
  out.push_back(simbody_family());
#endif
  return out;
}

}  // namespace plumb::bench
