#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "plumb/error.hpp"
#include "view/server/messages.hpp"

namespace plumb::view {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are written as numbers lie in memory");

template <class Number>
void put(std::string& out, std::type_identity_t<Number> value) {
  char bytes[sizeof(Number)];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

void put_u32(std::string& out, std::uint64_t value) {
  put<std::uint32_t>(out, static_cast<std::uint32_t>(value));
}

void put_f32(std::string& out, double value) {
  put<float>(out, static_cast<float>(value));
}

std::vector<std::uint32_t> gone_rods(const Side& side) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < side.scene().rods.size(); ++i)
    if (side.is_gone(i)) out.push_back(i);
  return out;
}

std::vector<float> values(const Side& side, Values which) {
  if (which == Values::strain) return side.strains();
  if (which == Values::tension) return side.tensions();
  return {};
}

double largest(const std::vector<float>& values) {
  double out = 0;
  for (const float value : values)
    if (std::abs(value) > out) out = std::abs(value);
  return out;
}

/// One resize for all: appending number by number takes five times as long.
void put_positions(std::string& out, const std::vector<Vec3>& positions) {
  const std::size_t from = out.size();
  out.resize(from + 3 * sizeof(float) * positions.size());
  char* to = out.data() + from;
  for (const Vec3& p : positions) {
    const float at[]{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    std::memcpy(to, at, sizeof at);
    to += sizeof at;
  }
}

void put_flags(std::string& out, const Side& side) {
  const std::size_t from = out.size(), count = side.asleep().size();
  out.resize(from + count);
  for (std::size_t i = 0; i < count; ++i)
    out[from + i] = static_cast<char>(side.asleep()[i] + (side.scene().particles[i].fixed ? 2 : 0));
}

void put_side(std::string& out, const Side& side, const Measured& measured, bool hashed, Values which) {
  const std::vector<Vec3> positions = side.positions();
  const std::vector<float> shown = values(side, which);
  const std::vector<std::uint32_t> gone = gone_rods(side);
  const StepReport& report = side.report();
  put_u32(out, positions.size());
  put_u32(out, shown.size());
  put_u32(out, gone.size());
  put_u32(out, side.world().info().islands);
  put_u32(out, report.awake_islands);
  put_u32(out, report.substeps);
  put_u32(out, report.block_sweeps);
  put_u32(out, report.newton);
  put<std::uint64_t>(out, hashed ? side.world().state_hash() : 0);
  put_f32(out, side.step_us());
  put_f32(out, measured.strain_rms);
  put_f32(out, measured.strain_max);
  put_f32(out, measured.energy.kinetic);
  put_f32(out, measured.energy.potential);
  put_f32(out, measured.energy.elastic);
  put_f32(out, measured.distance);
  put_f32(out, largest(shown));
  put_u32(out, report.skipped_within_tolerance);
  put_u32(out, report.unsolved + report.frozen_islands + report.inaccurate_steps + report.capped_steps);
  for (const double us : side.stage_us()) put_f32(out, us);
  put_positions(out, positions);
  for (const std::uint32_t rod : gone) put_u32(out, rod);
  for (const float value : shown) put<float>(out, value);
  put_flags(out, side);
  out.resize((out.size() + 3) / 4 * 4);
}

}  // namespace

Values values_of(std::string_view word) {
  if (word == "none") return Values::none;
  if (word == "strain") return Values::strain;
  if (word == "tension") return Values::tension;
  throw InputError("values '" + std::string(word) + "' are not one of none, strain, tension");
}

Measured measure(const Exhibit& exhibit, std::size_t side) {
  const Side& of = exhibit.sides()[side];
  const Stretch stretch = of.stretch();
  return {stretch.rms, stretch.max, of.energy(), exhibit.distance(side)};
}

std::string encode_frame(const Exhibit& exhibit, const Pace& pace, Values values,
                         const std::vector<Measured>& measured) {
  std::string out;
  double step_us = 0;
  std::size_t particles = 0;
  for (const Side& side : exhibit.sides()) {
    step_us += side.step_us();
    particles += side.scene().particles.size();
  }
  out.reserve(36 + 108 * exhibit.sides().size() + 18 * particles);
  put_u32(out, frame_magic);
  put_u32(out, exhibit.frame());
  put<double>(out, static_cast<double>(exhibit.frame()) * frame_length);
  put_u32(out, exhibit.sides().size());
  put_u32(out, (pace.playing ? 1U : 0U) + (pace.replaying ? 2U : 0U));
  put_f32(out, pace.reached);
  put_f32(out, step_us);
  put_f32(out, pace.frame_us);
  for (std::size_t i = 0; i < exhibit.sides().size(); ++i)
    put_side(out, exhibit.sides()[i], measured[i], pace.hashed, values);
  return out;
}

}  // namespace plumb::view
