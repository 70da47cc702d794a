// The worlds of plumb view in a page's worker, which hears and says what a server would. worker.js calls
// these functions, and has those that take what is said.
#include <emscripten.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <string>

#include "view/server/show.hpp"

// clang-format off
EM_JS(void, plumb_say_text, (const char* text), { sayText(UTF8ToString(text)); })
EM_JS(void, plumb_say_frame, (const char* bytes, std::size_t size), {
  sayFrame(HEAPU8.slice(bytes, bytes + size).buffer);
})
// clang-format on

namespace plumb::view {
namespace {

std::unique_ptr<Show> show;

void say(const std::string& text) {
  plumb_say_text(text.c_str());
}

void say_frame(const std::string& bytes) {
  plumb_say_frame(bytes.data(), bytes.size());
}

}  // namespace
}  // namespace plumb::view

using namespace plumb::view;

extern "C" {

/// Begins with what a replay says. It is repeated if it has frames; otherwise it is a start alone.
EMSCRIPTEN_KEEPALIVE void plumb_begin(const char* text) {
  try {
    std::optional<Replay> replay = parse_replay(text, "what this page starts from");
    Exhibit exhibit(replay->start);
    if (replay->frames == 0) replay.reset();
    show = std::make_unique<Show>(std::move(exhibit), Outlet{say, say_frame}, std::move(replay));
    show->greet();
    show->publish();
  } catch (const std::exception& error) {
    say(note_json(error.what(), true).dump());
  }
}

EMSCRIPTEN_KEEPALIVE void plumb_obey(const char* message) {
  if (!show) return;
  show->obey(message);
  if (!show->step_if_due()) show->publish();
}

/// Takes the next frame if it is due. Returns in how many ms the one after that is; -1 if worlds stand still.
EMSCRIPTEN_KEEPALIVE double plumb_tick() {
  if (!show) return -1;
  show->step_if_due();
  if (!show->is_playing()) return -1;
  const std::chrono::duration<double, std::milli> wait = show->due() - std::chrono::steady_clock::now();
  return std::max(0.0, wait.count());
}

}  // extern "C"
