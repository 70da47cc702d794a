#include "view/server/show.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include "plumb/error.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/scene_file.hpp"
#include "scenes/spec.hpp"

namespace plumb::view {
namespace {

/// Scenes of more particles are measured, and their states hashed, once in a while.
constexpr std::size_t small_scene = 5'000;
constexpr std::uint64_t frames_between_measures = 15;

/// From so many rods or moving shapes on, three worlds side by side fall to half of real time or far below.
/// What touches takes method direct long, which all comparisons have. Generators as they are by default have
/// either at most 1,984 rods and 100 shapes, and keep up, or at least 2,000 rods or 320 shapes, and do not.
constexpr std::size_t large_in_rods = 2'000, large_in_shapes = 200;

bool is_large(const Scene& scene) {
  return scene.rods.size() >= large_in_rods || scene.capsules.size() + scene.hulls.size() >= large_in_shapes;
}

std::size_t size_of(const Exhibit& exhibit) {
  std::size_t out = 0;
  for (const Side& side : exhibit.sides()) out += side.scene().particles.size();
  return out;
}

}  // namespace

Show::Show(Exhibit exhibit, Outlet outlet, std::optional<Replay> replay)
    : exhibit_(std::move(exhibit)), outlet_(std::move(outlet)) {
  if (replay) repeater_.emplace(std::move(*replay));
}

void Show::greet() {
  outlet_.text(menu_json().dump());
  show_worlds();
  pacing_.start(Clock::now());
}

void Show::show_worlds() {
  outlet_.text(scene_json(exhibit_).dump());
  outlet_.text(sides_json(exhibit_).dump());
  measured_.clear();
}

void Show::obey(const std::string& message) {
  try {
    obey(parse_request(message));
  } catch (const InputError& error) {
    outlet_.text(note_json(error.what(), true).dump());
    // Whoever moved a slider to where it cannot be sees it go back.
    outlet_.text(sides_json(exhibit_).dump());
  } catch (const std::exception& error) {
    outlet_.text(note_json(std::string("something failed: ") + error.what(), true).dump());
  }
}

void Show::obey(const Request& request) {
  if (is_input(request.verb)) return change(request);
  switch (request.verb) {
    case Verb::play:
      pacing_.start(Clock::now());
      playing_ = true;
      return;
    case Verb::pause:
      playing_ = false;
      return;
    case Verb::step:
      playing_ = false;
      return step();
    case Verb::speed:
      return set_speed(request);
    case Verb::reset:
      return begin_again(exhibit_.next_start());
    case Verb::defaults:
      return begin_again(original_);
    case Verb::load:
      return load(request);
    case Verb::compare: {
      Start start = exhibit_.next_start();
      start.sides = comparison(request.name).sides;
      begin_again(std::move(start));
      original_.sides = exhibit_.start().sides;
      aside_.reset();
      return;
    }
    case Verb::add_side:
    case Verb::drop_side:
      return change_sides(request);
    case Verb::values:
      values_ = values_of(request.name);
      return;
    case Verb::record:
      outlet_.text(scenes::Json{{"kind", "replay"}, {"text", format_replay(exhibit_)}}.dump());
      return;
    default:
      return;
  }
}

void Show::change(const Request& request) {
  if (is_replaying()) throw InputError("a replay runs; reset ends it");
  const std::size_t particles = exhibit_.sides().front().scene().particles.size();
  const std::string refused = exhibit_.take(request);
  if (!refused.empty()) outlet_.text(note_json(refused, true).dump());
  if (exhibit_.sides().front().scene().particles.size() != particles)
    show_worlds();
  else if (request.verb == Verb::set)
    outlet_.text(sides_json(exhibit_).dump());
}

void Show::begin_again(Start start) {
  exhibit_ = Exhibit(std::move(start));
  repeater_.reset();
  pacing_.start(Clock::now());
  show_worlds();
}

/// Begins with another scene. Where the worlds of now do not all move it, or would be slow, a single one
/// does. They come back with the next scene for them. Who chose several worlds for a large scene keeps them.
void Show::begin_with(Start start) {
  Start fresh{start.name, start.scene, original_.sides};
  if (aside_) {
    start.sides = aside_->now;
    fresh.sides = aside_->at_first;
  }
  Worlds chosen{start.sides, fresh.sides};
  const bool are_several = start.sides.size() > 1;
  const bool are_meant = !aside_ && is_large(exhibit_.start().scene);
  std::string reason;
  if (are_several && !are_meant && is_large(start.scene)) {
    reason = "this scene is large and several would be slow. Compare brings them back.";
  } else {
    try {
      begin_again(start);
    } catch (const InputError& error) {
      if (!are_several) throw;
      reason = std::string("not all could move this scene: ") + error.what();
    }
  }
  if (!reason.empty()) {
    start.sides = fresh.sides = comparison("one world").sides;
    begin_again(std::move(start));
    outlet_.text(note_json("One world, since " + reason, false).dump());
    aside_ = std::move(chosen);
  } else {
    aside_.reset();
  }
  original_ = std::move(fresh);
}

void Show::load(const Request& request) {
  Start start = exhibit_.next_start();
  start.name = request.name;
  if (request.value.empty()) {
    start.scene = scenes::load_scene(request.name);
  } else if (request.value.find("\"plumb_replay\"") != std::string::npos) {
    Replay replay = parse_replay(request.value, request.name);
    begin_again(replay.start);
    original_ = replay.start;
    aside_.reset();
    repeater_.emplace(std::move(replay));
    return;
  } else {
    start.scene = scenes::parse_scene(request.value, request.name);
  }
  begin_with(std::move(start));
}

void Show::set_speed(const Request& request) {
  const auto speed = scenes::parse_number<double>(request.value);
  if (!speed || !(*speed >= 0.01 && *speed <= 1)) throw InputError("speed must be from 0.01 to 1");
  pacing_.set_speed(*speed, Clock::now());
}

void Show::change_sides(const Request& request) {
  Start start = exhibit_.next_start();
  const std::size_t side = request.side.value_or(0);
  if (side >= start.sides.size()) throw InputError("no world " + std::to_string(side));
  if (request.verb == Verb::add_side) {
    start.sides.push_back(start.sides[side]);
    start.sides.back().name += again;
  } else {
    start.sides.erase(start.sides.begin() + static_cast<std::ptrdiff_t>(side));
  }
  begin_again(std::move(start));
  aside_.reset();
}

bool Show::step_if_due() {
  if (!playing_ || !pacing_.is_due(Clock::now())) return false;
  step();
  return true;
}

void Show::step() {
  try {
    advance();
  } catch (const std::exception& error) {
    playing_ = false;
    outlet_.text(note_json(std::string("the worlds stand still: ") + error.what(), true).dump());
  }
  publish();
}

void Show::advance() {
  const bool replays = is_replaying();
  if (replays) repeater_->give(exhibit_);
  exhibit_.step();
  pacing_.count(Clock::now());
  if (!replays || is_replaying()) return;
  repeater_->give(exhibit_);
  playing_ = false;
  const bool same = hashes_of(exhibit_) == repeater_->replay().hashes;
  outlet_.text(note_json(same ? "The replay ends with the same bits as when it was saved."
                              : "The replay ends with other bits than when it was saved.",
                         !same)
                   .dump());
  outlet_.text(sides_json(exhibit_).dump());
}

void Show::publish() {
  const Clock::time_point start = Clock::now();
  const bool is_small = size_of(exhibit_) <= small_scene;
  const bool is_due = is_small || !playing_ || published_++ % frames_between_measures == 0;
  if (is_due || measured_.size() != exhibit_.sides().size()) {
    measured_.clear();
    for (std::size_t i = 0; i < exhibit_.sides().size(); ++i) measured_.push_back(measure(exhibit_, i));
  }
  const Pace pace{playing_, is_replaying(), playing_ ? pacing_.reached() : 0, frame_us_, is_due};
  outlet_.frame(encode_frame(exhibit_, pace, values_, measured_));
  frame_us_ = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

}  // namespace plumb::view
