#include "scenes/spec.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <type_traits>
#include <variant>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/nearest.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/scene_file.hpp"
#include "scenes/generators/contacts.hpp"
#include "scenes/generators/falling.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/generators/wires.hpp"
#include "scenes/humanoid/humanoid.hpp"
#include "scenes/shots/shots.hpp"

namespace plumb::scenes {
namespace {

/// An assignment is one `key=value` of a spec.
struct Assignment {
  std::string_view key;
  std::string_view value;
};

/// A parameter has a name and the field of the shape that it sets. The field's initial value is the default.
template <class Shape>
struct Parameter {
  const char* name;
  std::variant<std::uint32_t Shape::*, std::uint64_t Shape::*, double Shape::*, BodyType Shape::*> field;
};

/// Returns the value that the text of an assignment spells. Throws InputError saying what `name` must be.
template <class Value>
Value parsed_value(const char* name, std::string_view text) {
  const auto refuse = [&](const std::string& kind, const std::string& meant = "") {
    return InputError(std::string(name) + " must be " + kind + ", not '" + std::string(text) + "'" + meant);
  };
  if constexpr (std::is_same_v<Value, BodyType>) {
    std::vector<std::string> known;
    for (const BodyType body : {BodyType::thin, BodyType::medium, BodyType::wide, BodyType::none}) {
      if (text == to_string(body)) return body;
      known.emplace_back(to_string(body));
    }
    throw refuse("one of " + joined(known), did_you_mean(text, known));
  } else {
    const auto parsed = parse_number<Value>(text);
    // Generators alone know the least value.
    const std::string whole = "a whole number in digits, below 2^" + std::to_string(8 * sizeof(Value));
    if (!parsed) throw refuse(std::is_floating_point_v<Value> ? "a number" : whole);
    return *parsed;
  }
}

template <class Value>
std::string value_text(Value value) {
  if constexpr (std::is_same_v<Value, BodyType>)
    return std::string(to_string(value));
  else
    return short_number(static_cast<double>(value));
}

template <class Shape>
using Parameters = std::vector<Parameter<Shape>>;

template <class Shape>
Shape assigned(const Parameters<Shape>& parameters, const Assignment& assignment, Shape shape) {
  std::vector<std::string> known;
  for (const Parameter<Shape>& parameter : parameters) {
    known.emplace_back(parameter.name);
    if (assignment.key != parameter.name) continue;
    std::visit(
        [&](auto field) {
          using Value = std::remove_reference_t<decltype(shape.*field)>;
          shape.*field = parsed_value<Value>(parameter.name, assignment.value);
        },
        parameter.field);
    return shape;
  }
  const std::string own = known.empty() ? "it takes none of its own" : "known are " + joined(known);
  known.insert(known.end(), {"stiffness", "damping", "strength", "cables"});
  throw InputError("no parameter '" + std::string(assignment.key) + "'; " + own +
                   ", and of all scenes stiffness, damping, strength, cables" +
                   did_you_mean(assignment.key, known));
}

/// Takes the assignments that say how rods give, which every generator has.
RodLaw take_law(std::vector<Assignment>& assignments) {
  static const Parameters<RodLaw> parameters{
      {"stiffness", &RodLaw::stiffness}, {"damping", &RodLaw::damping}, {"strength", &RodLaw::strength}};
  RodLaw law;
  std::erase_if(assignments, [&](const Assignment& assignment) {
    if (assignment.key == "cables") {
      law.one_sided = parsed_value<std::uint32_t>("cables", assignment.value) != 0;
      return true;
    }
    const auto is_named = [&](const Parameter<RodLaw>& each) { return assignment.key == each.name; };
    if (std::none_of(parameters.begin(), parameters.end(), is_named)) return false;
    law = assigned(parameters, assignment, law);
    return true;
  });
  return law;
}

struct Generator {
  const char* name;
  const char* summary;
  std::string defaults;  ///< Defaults as text that load_scene reads.
  std::function<Scene(const std::vector<Assignment>&)> build;
};

template <class Shape>
Generator describe(const char* name, const char* summary, Scene (*make)(const Shape&),
                   Parameters<Shape> parameters) {
  static const Shape initial{};
  std::string defaults;
  for (const Parameter<Shape>& p : parameters) {
    append_item(defaults, p.name, ",");
    defaults += '=';
    std::visit([&](auto field) { defaults += value_text(initial.*field); }, p.field);
  }
  return {name, summary, defaults, [=](const std::vector<Assignment>& assignments) {
            Shape shape;
            for (const Assignment& a : assignments) shape = assigned(parameters, a, shape);
            return make(shape);
          }};
}

std::vector<Generator> chains_and_nets() {
  using C = ChainShape;
  using H = WinchShape;
  using L = LineShape;
  using N = NetShape;
  using E = EnsembleShape;
  using R = RingShape;
  using T = TrussShape;
  return {
      describe<C>(
          "chain", "massless rods straight along +x from a fixed particle; the last particle may be heavy",
          make_chain,
          {{"links", &C::links}, {"length", &C::length}, {"mass", &C::mass}, {"end_mass", &C::end_mass}}),
      describe<C>("thesis5", "the thesis's chain: five links, the last particle of double mass",
                  [](const C&) { return make_thesis5(); }, {}),
      describe<L>("line", "massless rods between two anchors, drawn straight; slack below 0: too short",
                  make_line,
                  {{"links", &L::links}, {"span", &L::span}, {"slack", &L::slack}, {"mass", &L::mass}}),
      describe<H>("winch", "a rope with a load at a slant, whose first rod is the cable that is reeled in",
                  make_winch,
                  {{"rods", &H::rods},
                   {"cable", &H::cable},
                   {"length", &H::length},
                   {"mass", &H::mass},
                   {"load", &H::load}}),
      describe<N>(
          "net",
          "a square net hanging from two fixed upper corners; level=1: held along one side, level at first",
          make_net,
          {{"width", &N::width},
           {"height", &N::height},
           {"spacing", &N::spacing},
           {"mass", &N::mass},
           {"level", &N::level},
           {"slack", &N::slack},
           {"end_mass", &N::end_mass}}),
      describe<E>("ensemble", "separate chains side by side, each from a fixed particle", make_ensemble,
                  {{"chains", &E::chains},
                   {"links", &E::links},
                   {"length", &E::length},
                   {"mass", &E::mass},
                   {"end_mass", &E::end_mass},
                   {"spacing", &E::spacing},
                   {"vary", &E::vary},
                   {"seed", &E::seed}}),
      describe<R>("ring", "a ring of massless rods hanging from one fixed particle", make_ring,
                  {{"links", &R::links}, {"length", &R::length}, {"mass", &R::mass}}),
      describe<T>("truss", "a truss along +x, fixed at one end; over-constrained with two braces", make_truss,
                  {{"bays", &T::bays},
                   {"chords", &T::chords},
                   {"braces", &T::braces},
                   {"fixed", &T::fixed},
                   {"spacing", &T::spacing},
                   {"mass", &T::mass}}),
      describe<C>("rods5", "five uniform rods with mass in a row, the last twice as heavy",
                  [](const C&) { return make_rods5(); }, {}),
      describe<C>("tree", "six rods with mass that branch twice", [](const C&) { return make_tree(); }, {}),
  };
}

std::vector<Generator> figures_and_solids() {
  using G = GraphShape;
  using H = HumanoidShape;
  using W = CrowdShape;
  using S = StickBoxShape;
  using D = DropShape;
  using V = WireShape;
  return {
      describe<H>("humanoid",
                  "the thesis's nine limbs as rods with mass, level from the top of the head; "
                  "body=thin|medium|wide: standing on the ground, asleep; arms=1: with them, and knees that "
                  "bend one way",
                  make_humanoid,
                  {{"body", &H::body},
                   {"friction", &H::friction},
                   {"joint_drag", &H::joint_drag},
                   {"arms", &H::arms}}),
      describe<G>("graph", "particles strewn over a cube, the nearest tied together, masses 0.5 to 2 kg",
                  make_graph,
                  {{"particles", &G::particles},
                   {"degree", &G::degree},
                   {"spacing", &G::spacing},
                   {"seed", &G::seed}}),
      describe<W>("crowd", "a square field of standing humanoids, asleep; balls fly at `hit` of them",
                  make_crowd,
                  {{"humanoids", &W::humanoids},
                   {"hit", &W::hit},
                   {"body", &W::body},
                   {"friction", &W::friction},
                   {"joint_drag", &W::joint_drag},
                   {"speed", &W::speed}}),
      describe<S>("stick_box", "the thesis's stick, thrown in a box of six planes", make_stick_box,
                  {{"length", &S::length},
                   {"size", &S::size},
                   {"speed", &S::speed},
                   {"spin", &S::spin},
                   {"restitution", &S::restitution},
                   {"friction", &S::friction}}),
      describe<D>("drop", "a ball above a plane", make_drop,
                  {{"height", &D::height},
                   {"radius", &D::radius},
                   {"mass", &D::mass},
                   {"restitution", &D::restitution},
                   {"friction", &D::friction}}),
      describe<V>("wire", "a wire clamped at one end, straight along +x and twisted", make_wire,
                  {{"rods", &V::rods},
                   {"length", &V::length},
                   {"mass", &V::mass},
                   {"bending", &V::bending},
                   {"torsion", &V::torsion},
                   {"twist", &V::twist}}),
  };
}

std::vector<Generator> what_falls() {
  using R = RopeShape;
  using H = HeapShape;
  using D = DrapeShape;
  return {
      describe<R>("rope", "a rope that falls on a plane, level or, with the radius of a coil, wound",
                  make_rope,
                  {{"links", &R::links},
                   {"length", &R::length},
                   {"mass", &R::mass},
                   {"radius", &R::radius},
                   {"height", &R::height},
                   {"coil", &R::coil},
                   {"pitch", &R::pitch},
                   {"friction", &R::friction}}),
      describe<H>("heap", "level ropes that fall on a plane and on each other", make_heap,
                  {{"ropes", &H::ropes},
                   {"links", &H::links},
                   {"length", &H::length},
                   {"mass", &H::mass},
                   {"radius", &H::radius},
                   {"spacing", &H::spacing},
                   {"friction", &H::friction},
                   {"seed", &H::seed}}),
      describe<D>("drape",
                  "a level net that falls on a box, with sphere=1 on a sphere, or with box=0 on a plane",
                  make_drape,
                  {{"size", &D::size},
                   {"spacing", &D::spacing},
                   {"mass", &D::mass},
                   {"radius", &D::radius},
                   {"height", &D::height},
                   {"friction", &D::friction},
                   {"box", &D::box},
                   {"sphere", &D::sphere}}),
  };
}

std::vector<Generator> what_falls_in_numbers() {
  using T = TerrainShape;
  using S = ShotShape;
  using B = BoxesShape;
  using P = PileShape;
  return {
      describe<T>("terrain", "stacks of ropes that fall on hilly ground of triangles and on each other",
                  make_terrain,
                  {{"ropes", &T::ropes},
                   {"links", &T::links},
                   {"length", &T::length},
                   {"mass", &T::mass},
                   {"radius", &T::radius},
                   {"spacing", &T::spacing},
                   {"stack", &T::stack},
                   {"triangles", &T::triangles},
                   {"hills", &T::hills},
                   {"friction", &T::friction},
                   {"seed", &T::seed}}),
      describe<B>("boxes", "turned boxes that fall on a plane and on each other", make_boxes,
                  {{"boxes", &B::boxes},
                   {"size", &B::size},
                   {"mass", &B::mass},
                   {"height", &B::height},
                   {"friction", &B::friction},
                   {"seed", &B::seed}}),
      describe<P>("pile", "humanoids that lie in layers and fall in one heap on a plane", make_pile,
                  {{"figures", &P::figures},
                   {"gap", &P::gap},
                   {"body", &P::body},
                   {"friction", &P::friction},
                   {"joint_drag", &P::joint_drag},
                   {"seed", &P::seed}}),
      describe<S>(
          "shot",
          "a random ball, rod, rope or box hits ground, a rope, a net, a figure or a box at once, without "
          "gravity, and flies off; each number=N is another",
          make_shot_scene, {{"number", &S::number}, {"seed", &S::seed}}),
  };
}

/// A new generator is one more entry above, and help lists them in this order.
const std::vector<Generator>& generators() {
  static const std::vector<Generator> list = [] {
    std::vector<Generator> out = chains_and_nets();
    for (Generator& generator : figures_and_solids()) out.push_back(std::move(generator));
    for (Generator& generator : what_falls()) out.push_back(std::move(generator));
    for (Generator& generator : what_falls_in_numbers()) out.push_back(std::move(generator));
    return out;
  }();
  return list;
}

std::vector<Assignment> split(std::string_view text) {
  std::vector<Assignment> out;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0) {
      throw InputError("expected key=value, found '" + std::string(item) + "'");
    }
    const Assignment added{item.substr(0, equals), item.substr(equals + 1)};
    for (const Assignment& earlier : out) {
      if (earlier.key == added.key) throw InputError(std::string(added.key) + " is given twice");
    }
    out.push_back(added);
    if (comma == std::string_view::npos) return out;
    text.remove_prefix(comma + 1);
  }
}

bool names_a_file(std::string_view spec) {
  std::error_code ignored;
  return spec.ends_with(".json") || std::filesystem::is_regular_file(spec, ignored);
}

}  // namespace

Scene load_scene(std::string_view spec) {
  if (names_a_file(spec)) return read_scene(spec);
  const std::size_t colon = spec.find(':');
  const std::string_view name = spec.substr(0, colon);
  std::vector<std::string> known;
  for (const Generator& generator : generators()) {
    known.emplace_back(generator.name);
    if (name != generator.name) continue;
    try {
      std::vector<Assignment> assignments;
      if (colon != std::string_view::npos) assignments = split(spec.substr(colon + 1));
      const RodLaw law = take_law(assignments);
      Scene scene = generator.build(assignments);
      for (Rod& rod : scene.rods) rod.law = law;
      validate(scene);
      return scene;
    } catch (const InputError& error) {
      throw InputError("scene '" + std::string(spec) + "': " + error.what());
    }
  }
  std::error_code ignored;
  const char* const there =
      std::filesystem::is_directory(spec, ignored) ? "it is a folder" : "there is no such file";
  throw InputError("no scene '" + std::string(spec) + "': " + there + ", and the generators are " +
                   joined(known) + did_you_mean(name, known));
}

std::vector<GeneratorHelp> list_generators() {
  std::vector<GeneratorHelp> out;
  for (const Generator& generator : generators()) {
    out.push_back({generator.name, generator.summary, generator.defaults});
  }
  return out;
}

}  // namespace plumb::scenes
