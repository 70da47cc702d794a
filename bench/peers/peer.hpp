#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "links.hpp"
#include "plumb/measures.hpp"

/// This file puts other libraries behind one interface, so that they are measured alike.
namespace plumb::bench {

/// Says what is to be built in another library.
struct Model {
  const Scene& scene;
  const std::vector<Link>& links;
  double duration = 1;  ///< s
};

/// Holds a scene as another library does, in double precision and on one thread. Step and copy throw a
/// std::exception where the library itself gives up.
class Peer {
 public:
  Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  /// Moves on by a frame of 1/60 s. This alone is timed.
  virtual void step_frame() = 0;
  /// Copies the movable particles' positions and velocities, in the scene's order. Fixed particles are left
  /// alone.
  virtual void copy_state(Frame& frame) = 0;
};

inline constexpr std::uint32_t frames_per_second = 60;

/// Holds ever finer settings of one method of a library.
struct PeerPath {
  std::uint32_t levels = 16;
  /// Returns the setting of a level in few words, without commas.
  std::function<std::string(std::uint32_t)> name{};
  std::function<std::unique_ptr<Peer>(const Model&, std::uint32_t)> make{};
};

/// Names a library, or one of its methods that is drawn as one.
struct PeerFamily {
  std::string name{};
  /// The nearest of its settings must have this position error on the chain that models are checked on.
  double must_reach = 0;
  /// Scenes with more links are not tried.
  std::size_t most_links = 1 << 20;
  std::vector<PeerPath> paths{};
};

/// Makes a path whose levels halve the step: "LABEL 60x8" is eight steps in each of 60 frames a second.
/// `make` gets the steps in a frame.
PeerPath halving_path(const std::string& label, const std::string& suffix,
                      std::function<std::unique_ptr<Peer>(const Model&, std::uint32_t)> make);

PeerFamily bullet_soft_family();
PeerFamily bullet_multibody_family();
PeerFamily mujoco_family();
PeerFamily simbody_family();

/// Returns the families that this program was built with.
std::vector<PeerFamily> all_peers();

}  // namespace plumb::bench
