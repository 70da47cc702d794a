// A world draws itself on a canvas of the program: here into an SVG file, with rods by what they bear.
#include <cstdio>
#include <fstream>
#include <plumb/plumb.hpp>
#include <string_view>

namespace {

/// Looks along -z: 1 m is 100 units, and up is up.
class Svg : public plumb::Canvas {
 public:
  explicit Svg(const char* path) : out_(path) {
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-50 -50 500 300\" font-size=\"8\">\n"
            "<rect x=\"-50\" y=\"-50\" width=\"500\" height=\"300\" fill=\"#181818\"/>\n";
  }
  ~Svg() override { out_ << "</svg>\n"; }
  Svg(const Svg&) = delete;
  Svg& operator=(const Svg&) = delete;

  void line(plumb::Vec3 from, plumb::Vec3 to, plumb::Color color) override {
    out_ << "<line x1=\"" << 100 * from.x << "\" y1=\"" << -100 * from.y << "\" x2=\"" << 100 * to.x
         << "\" y2=\"" << -100 * to.y << "\" stroke=\"";
    write(color);
    red_lines += color == plumb::Palette{}.stretched;
    ++lines;
  }
  void point(plumb::Vec3 at, plumb::Color color) override {
    out_ << "<circle r=\"3\" cx=\"" << 100 * at.x << "\" cy=\"" << -100 * at.y << "\" fill=\"";
    write(color);
    ++points;
  }
  void text(plumb::Vec3 at, std::string_view text, plumb::Color color) override {
    out_ << "<text x=\"" << 100 * at.x << "\" y=\"" << -100 * at.y << "\" fill=\"";
    write(color, false);
    out_ << '>' << text << "</text>\n";
    ++texts;
  }

  int lines = 0, red_lines = 0, points = 0, texts = 0;

 private:
  void write(plumb::Color color, bool ends = true) {
    out_ << "rgb(" << +color.red << ',' << +color.green << ',' << +color.blue << (ends ? ")\"/>\n" : ")\"");
  }

  std::ofstream out_;
};

}  // namespace

int main() {
  plumb::Scene scene;  // a rope between two posts, and a weight in its middle
  for (unsigned i = 0; i <= 20; ++i) {
    scene.particles.push_back({.position = {0.2 * i, 0, 0}, .mass = i == 10 ? 20.0 : 0.1});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = 0.21});
  }
  scene.particles.front().fixed = scene.particles.back().fixed = true;
  scene.drag = 2;
  plumb::World world(scene, {.method = plumb::Method::relax, .substeps = 8, .tensions = true});
  for (int frame = 0; frame < 600; ++frame) world.step(1.0 / 60);

  Svg svg("draw.svg");
  plumb::Drawing drawing;
  drawing.draw(
      world, svg,
      {.tone = plumb::RodTone::tension, .full = 0.9 * world.tension(9), .bounds = true, .numbers = true});
  std::printf("%d lines, %d of them pull hard; %d points and %d numbers in draw.svg\n", svg.lines,
              svg.red_lines, svg.points, svg.texts);
}
