#pragma once

#include <algorithm>

namespace plumb::detail {

/// Says what shorter substeps do with the violations that a longer one left.
///
/// What sweeps leave of a pull goes as the square of the substep. A shorter one that took all of it back
/// would pull as much harder, and throw what it pulls. So it takes back what one of its own length would have
/// left, and keeps the rest for a while, as if rods were as long.
struct Leftovers {
  double time = 0;  ///< s, the substep that left what is kept, less as that fades
  double last = 0;  ///< s, the substep before; 0 before the first

  bool any() const { return last < time; }
  /// Returns the share of what the last substep left that one of `h` (s) keeps.
  double keeps(double h) const { return is_shorter(h, last) ? 1 - h / last * (h / last) : 0; }
  /// Returns the share of what was kept that it takes back: all if it is as long as what left it.
  double fades(double h) const {
    if (!is_shorter(h, time)) return 1;
    constexpr double longest = 0.5;  // s, for what a frame left that hung
    return std::min(1.0, std::max(h / time * (h / time), h / std::min(16 * time, longest)));
  }
  /// Returns the share of what held contacts in the last substep (N) with which one of `h` begins. If the
  /// last was less than half as long as those before, it is at most twice its impulse.
  double force_share(double h) const {
    const double usual = std::min(h, time);
    return last > 0 && 2 * last < usual ? 2 * last / usual : 1;
  }
  /// Goes on with what others left, too. How much of it was to be kept is not known.
  void go_on(const Leftovers& from) { time = last = std::max(time, from.time); }
  /// Lets a substep of `h` pass.
  void pass(double h) {
    time = is_shorter(h, time) ? std::max(h, time - fades(h) / 2 * time) : h;
    last = h;
  }

 private:
  /// Frames differ a little all the time, which matters as little.
  static bool is_shorter(double h, double than) { return h < 0.9 * than; }
};

/// Says which shares of violations a substep keeps: of what it finds more than was kept, and of that.
template <class T>
class Keeping {
 public:
  Keeping(const Leftovers& leftovers, double h)
      : keeps_(static_cast<T>(leftovers.keeps(h))), fades_(static_cast<T>(leftovers.fades(h))) {}
  /// Returns what is kept of what is `off`, of which `kept` was.
  T of(T off, T kept) const {
    const T wanted = (kept + keeps_ * (off - kept)) * (1 - fades_);
    return std::clamp(wanted, std::min(off, T(0)), std::max(off, T(0)));
  }

 private:
  T keeps_, fades_;
};

}  // namespace plumb::detail
