#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "plumb/export.hpp"
#include "plumb/vec3.hpp"
#include "plumb/world.hpp"

/// @file
/// This file draws what a world is like, for whoever debugs a scene. A program gives a canvas that knows
/// lines, points and text; plumb says what goes where, in which colour.
namespace plumb {

/// This is a colour of light, 0 to 255 each, which does not let anything through.
struct Color {
  std::uint8_t red = 0;    ///< Red.
  std::uint8_t green = 0;  ///< Green.
  std::uint8_t blue = 0;   ///< Blue.

  /// Returns whether all members are equal.
  friend constexpr bool operator==(const Color&, const Color&) = default;
};

/// Takes what is drawn. Places are in m. Calls come from the thread that calls Drawing::draw(), and what they
/// throw ends it.
class PLUMB_API Canvas {
 public:
  virtual ~Canvas();
  virtual void line(Vec3 from, Vec3 to, Color color) = 0;              ///< Draws a straight line.
  virtual void point(Vec3 at, Color color) = 0;                        ///< Marks a place.
  virtual void text(Vec3 at, std::string_view text, Color color) = 0;  ///< Writes beside a place.
};

/// Says which colour stands for what.
struct Palette {
  Color rod{200, 200, 200};      ///< Rods that are not drawn by what they bear, or that bear nothing.
  Color stretched{230, 60, 40};  ///< Rods that pull as much as DrawChoice::full, or are as much too long.
  Color pressed{50, 110, 230};   ///< Rods that push as much, or are as much too short.
  Color asleep{90, 90, 90};      ///< What sleeps is mixed with three parts of this.
  Color frozen{200, 60, 220};    ///< Rods, cords and springs of islands that World::problems() calls frozen.
  Color cord{190, 150, 90};      ///< Cords of tackles, and springs.
  Color anchor{240, 200, 40};    ///< Fixed particles.
  Color contact{60, 200, 90};    ///< Where shapes touch, and the normal there.
  Color grab{240, 130, 30};      ///< Grabs, from the place to its target.
  Color bounds{70, 130, 130};    ///< Boxes around islands.
  Color joint{130, 200, 230};    ///< Ball joints, directions of alignments and axes of torsions.
  Color body{230, 230, 230};     ///< Axes of bodies, and numbers.
};

/// Says by what the colours of rods go. What they bear is their strain, or their pull as World::tension() has
/// it.
enum class RodTone : std::uint8_t { plain, strain, tension };

/// Says what is drawn, and how.
struct DrawChoice {
  bool rods = true;                ///< Rods that are not broken; cords of tackles; springs.
  RodTone tone = RodTone::strain;  ///< By what the colours of rods go.
  double full = 0.01;              ///< Strain, or pull in N, from which on a rod has its full colour.
  bool asleep = true;              ///< Whether what sleeps is dim.
  bool anchors = true;             ///< Fixed particles from which something hangs or may hang.
  bool contacts = true;            ///< Contacts of the last step, if Settings::contacts lists them.
  bool grabs = true;               ///< Grabs that hold.
  bool bounds = false;             ///< Boxes around the movable particles of each island.
  bool joints = true;              ///< Ball joints, alignments and torsions.
  bool bodies = true;              ///< The axes of bodies, from their centres of mass.
  bool numbers = false;            ///< Numbers of rods beside their middles, and of bodies.
  double length = 0.1;             ///< Length in m of normals, and of the axes of bodies.
  Palette colors{};                ///< Which colour stands for what.
};

/// Draws a world on a canvas between two steps. A world that is not drawn pays nothing for it.
///
///     plumb::Drawing drawing;
///     drawing.draw(world, canvas);                       // after a step
///     drawing.draw(world, canvas, {.tone = plumb::RodTone::tension, .full = 500});
///
/// All is drawn that is there now, with what was added and joined. It comes in a fixed order: rods, cords,
/// springs, joints, bodies, anchors, grabs, contacts, bounds, and of each by number. Drawing changes nothing
/// of a world, and reads it as one thread may. It keeps its memory from call to call, but for boxes.
class PLUMB_API Drawing {
 public:
  Drawing();
  ~Drawing();
  Drawing(Drawing&&) noexcept;             ///< Moves all; what is left can only be assigned to.
  Drawing& operator=(Drawing&&) noexcept;  ///< Moves all; what is left can only be assigned to.

  /// Draws what is chosen. Throws InputError if `full` or `length` is not positive and finite, and if rods
  /// are to show tensions without Settings::tensions; then nothing is drawn.
  void draw(const World& world, Canvas& canvas, const DrawChoice& choice = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumb
