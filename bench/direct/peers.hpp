#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace plumb::bench {

/// Holds what another library takes to meet a target, in ms per simulated second. `ms` is 0 if none met it.
///
/// Times were measured on one core of another machine (Zen 5, 3.75 GHz, g++ 12 -O3). A ratio to one is not a
/// ratio of two numbers of the same run.
struct Peer {
  std::string_view name;
  double ms;
};

/// Holds the cheapest of Jolt 5.5's soft body, Box2D v3, Bullet 3.24's multibody, MuJoCo and Simbody. They
/// moved a chain of that many links, straight to the side at first. Its last particle is `end_mass` times as
/// heavy as the others.
struct PeerRow {
  std::uint32_t links;
  double end_mass;
  std::array<Peer, 3> targets;  ///< stretch and error 5 % and 5 %, 1 % and 1 %, 1 % and 0.1 %
};

inline constexpr PeerRow peer_rows[] = {
    {5, 10, {{{"Jolt soft", 0.265}, {"Box2D", 0.454}, {"MuJoCo RK4", 1.18}}}},
    {5, 1000, {{{"Jolt soft", 0.423}, {"Jolt soft", 2.1}, {"Bullet multibody RK4", 3.5}}}},
    {20, 10, {{{"Jolt soft", 0.59}, {"Jolt soft", 1.23}, {"Box2D", 3.89}}}},
    {20, 1000, {{{"Jolt soft", 1.23}, {"MuJoCo", 5.72}, {"MuJoCo RK4", 22.9}}}},
    {100, 10, {{{"Jolt soft", 5.5}, {"Bullet multibody", 14.8}, {"Box2D", 18.7}}}},
    {100, 1000, {{{"Jolt soft", 5.5}, {"Bullet multibody", 14.8}, {"Bullet multibody", 14.8}}}},
    {1000, 10, {{{"Jolt soft", 45}, {"Jolt soft", 114}, {"Bullet multibody", 164}}}},
    {1000, 1000, {{{"Box2D", 148}, {"none", 0}, {"none", 0}}}},
};

/// This peer moved 1000 chains of 32 rods with end mass 10 side by side, with 1.1 % RMS stretch. It took 3.4
/// ms per frame of 1/60 s; the number here is ms per chain and simulated second.
inline constexpr Peer peer_ensemble{"Jolt soft, 5 iterations", 3.4 * 60 / 1000};

/// Returns the row of such a chain, or null.
inline const PeerRow* find_peer(std::uint32_t links, double end_mass) {
  for (const PeerRow& row : peer_rows)
    if (row.links == links && row.end_mass == end_mass) return &row;
  return nullptr;
}

}  // namespace plumb::bench
