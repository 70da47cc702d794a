// Two players pull at ropes. Whoever hears late of the other's input goes back to then, and steps again.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <vector>

namespace {

constexpr std::uint32_t links = 16;

plumb::Scene two_ropes() {
  plumb::Scene scene;
  for (std::uint32_t player = 0; player < 2; ++player)
    for (std::uint32_t i = 0; i <= links; ++i) {
      const std::uint32_t particle = player * (links + 1) + i;
      scene.particles.push_back({.position = {0.1 * i, 0, 1.0 * player}, .mass = 1, .fixed = i == 0});
      if (i > 0) scene.rods.push_back({.a = particle - 1, .b = particle});
    }
  return scene;
}

/// Returns where a player's hand is in a frame.
plumb::Vec3 hand(std::uint32_t player, int frame) {
  return {0, frame % 20 < 10 ? 0.01 * (frame % 10) : 0, 1.0 * player};
}

}  // namespace

int main() {
  const plumb::Scene scene = two_ropes();
  plumb::World host(scene, {.substeps = 4}), guest(scene, {.substeps = 4});
  const auto step = [](plumb::World& world, const std::array<plumb::Vec3, 2>& hands) {
    world.move_anchor(0, hands[0]);
    world.move_anchor(links + 1, hands[1]);
    world.step(1.0 / 60);
  };
  // The guest guesses that the host's hand rests, and hears five frames later what it did.
  constexpr int late = 5;
  std::array<std::vector<std::byte>, late> kept;
  int again = 0;
  for (int frame = 0; frame < 120; ++frame) {
    step(host, {hand(0, frame), hand(1, frame)});

    std::vector<std::byte>& now = kept[frame % late];
    if (frame >= late) {  // `now` is of five frames ago
      guest.restore(now);
      for (int past = frame - late; past < frame; ++past, ++again) {
        kept[past % late].resize(guest.snapshot_size());
        guest.save(kept[past % late]);
        step(guest, {hand(0, past), hand(1, past)});
      }
    }
    now.resize(guest.snapshot_size());
    guest.save(now);
    step(guest, {plumb::Vec3{}, hand(1, frame)});
  }
  // The guest hears of the last five frames, too.
  guest.restore(kept[115 % late]);
  for (int past = 115; past < 120; ++past) step(guest, {hand(0, past), hand(1, past)});
  std::printf("%d frames stepped again; the worlds are %s\n", again,
              host.state_hash() == guest.state_hash() ? "the same to the bit" : "apart");
}
