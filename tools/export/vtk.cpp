#include "export/vtk.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <pugixml.hpp>
#include <sstream>

#include "export/base64.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::tools {
namespace {

constexpr const char* byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

template <class T>
constexpr const char* type_name = "";
template <>
constexpr const char* type_name<double> = "Float64";
template <>
constexpr const char* type_name<std::int64_t> = "Int64";
template <>
constexpr const char* type_name<std::uint8_t> = "UInt8";

/// Writes a <DataArray>, which holds its size in bytes and then its numbers, as one run of base64.
template <class T>
void add_array(pugi::xml_node parent, const char* name, const std::vector<T>& values, int components = 1) {
  const std::uint64_t size = values.size() * sizeof(T);
  std::vector<unsigned char> bytes(sizeof size + size);
  std::memcpy(bytes.data(), &size, sizeof size);
  if (size > 0) std::memcpy(bytes.data() + sizeof size, values.data(), size);
  pugi::xml_node array = parent.append_child("DataArray");
  array.append_attribute("type") = type_name<T>;
  array.append_attribute("Name") = name;
  array.append_attribute("NumberOfComponents") = components;
  array.append_attribute("format") = "binary";
  array.text() = encode_base64(bytes).c_str();
}

void add_vectors(pugi::xml_node parent, const char* name, const std::vector<Vec3>& vectors) {
  std::vector<double> numbers;
  numbers.reserve(3 * vectors.size());
  for (const Vec3& v : vectors) numbers.insert(numbers.end(), {v.x, v.y, v.z});
  add_array(parent, name, numbers, 3);
}

/// Adds what belongs to no point or line, by its number in the scene.
void add_field_data(pugi::xml_node data, const scenes::Forces& forces) {
  const auto count = [&](std::size_t tuples) {
    data.last_child().append_attribute("NumberOfTuples") = static_cast<unsigned long long>(tuples);
  };
  const std::pair<const char*, const std::vector<Vec3>*> vectors[] = {
      {"pin", &forces.pins}, {"spring", &forces.springs}, {"capsule", &forces.contacts}};
  for (const auto& [name, of] : vectors) {
    if (of->empty()) continue;
    add_vectors(data, name, *of);
    count(of->size());
  }
  const std::pair<const char*, const std::vector<double>*> numbers[] = {{"angle", &forces.angles},
                                                                        {"torsion", &forces.torsions}};
  for (const auto& [name, of] : numbers) {
    if (of->empty()) continue;
    add_array(data, name, *of);
    count(of->size());
  }
}

pugi::xml_node add_file(pugi::xml_document& document, const char* type) {
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  pugi::xml_node file = document.append_child("VTKFile");
  file.append_attribute("type") = type;
  file.append_attribute("version") = "1.0";
  file.append_attribute("byte_order") = byte_order;
  file.append_attribute("header_type") = "UInt64";
  return file;
}

std::string text_of(const pugi::xml_document& document) {
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

std::vector<std::int64_t> loose_particles(const Scene& scene) {
  std::vector<bool> held(scene.particles.size(), false);
  for (const Rod& rod : scene.rods) held[rod.a] = held[rod.b] = true;
  std::vector<std::int64_t> loose;
  for (std::size_t i = 0; i < held.size(); ++i)
    if (!held[i]) loose.push_back(static_cast<std::int64_t>(i));
  return loose;
}

void add_point_data(pugi::xml_node piece, const Scene& scene, const scenes::RunFrame& frame) {
  std::vector<double> masses = lumped_masses(scene);
  std::vector<std::uint8_t> fixed;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    fixed.push_back(scene.particles[i].fixed);
    if (fixed.back()) masses[i] = 0;
  }
  pugi::xml_node data = piece.append_child("PointData");
  data.append_attribute("Vectors") = "velocity";
  data.append_attribute("Scalars") = "mass";
  add_vectors(data, "velocity", frame.velocities);
  add_array(data, "mass", masses);
  add_array(data, "fixed", fixed);
  if (!frame.forces.is_empty()) add_vectors(data, "reaction", frame.forces.reactions);
}

void add_cell_data(pugi::xml_node piece, const Scene& scene, const Frame& frame,
                   const std::vector<std::int64_t>& loose) {
  const std::size_t vertices = loose.size();
  std::vector<std::int64_t> rods(vertices, -1);
  std::vector<double> stretch(vertices, 0), radius(vertices, 0);
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    const double length = rod_length(scene, i);
    rods.push_back(static_cast<std::int64_t>(i));
    stretch.push_back((norm(frame.positions[rod.b] - frame.positions[rod.a]) - length) / length);
    radius.push_back(0);
  }
  for (const scenes::Limb& limb : scenes::list_limbs(scene)) {
    if (limb.rod) radius[vertices + *limb.rod] = limb.radius;
    if (!limb.particle) continue;
    const auto it = std::lower_bound(loose.begin(), loose.end(), std::int64_t{*limb.particle});
    if (it != loose.end() && *it == *limb.particle)
      radius[static_cast<std::size_t>(it - loose.begin())] = limb.radius;
  }
  pugi::xml_node data = piece.append_child("CellData");
  data.append_attribute("Scalars") = "stretch";
  add_array(data, "rod", rods);
  add_array(data, "stretch", stretch);
  add_array(data, "radius", radius);
  if (frame.tensions.empty()) return;
  std::vector<double> tension(vertices, 0);
  tension.insert(tension.end(), frame.tensions.begin(), frame.tensions.end());
  add_array(data, "tension", tension);
}

/// Writes <Verts> or <Lines>, with `connectivity` in cells of `width` points.
void add_cells(pugi::xml_node piece, const char* kind, const std::vector<std::int64_t>& connectivity,
               std::size_t width) {
  std::vector<std::int64_t> offsets;
  for (std::size_t end = width; end <= connectivity.size(); end += width)
    offsets.push_back(static_cast<std::int64_t>(end));
  pugi::xml_node cells = piece.append_child(kind);
  add_array(cells, "connectivity", connectivity);
  add_array(cells, "offsets", offsets);
}

std::string frame_name(std::size_t number) {
  char name[40];
  std::snprintf(name, sizeof name, "frame_%06zu.vtp", number);
  return name;
}

}  // namespace

std::string vtp_text(const Scene& scene, const scenes::RunFrame& frame) {
  const std::vector<std::int64_t> loose = loose_particles(scene);
  std::vector<std::int64_t> ends;
  for (const Rod& rod : scene.rods) ends.insert(ends.end(), {rod.a, rod.b});
  pugi::xml_document document;
  pugi::xml_node poly = add_file(document, "PolyData").append_child("PolyData");
  pugi::xml_node time = poly.append_child("FieldData");
  add_array(time, "TimeValue", std::vector<double>{frame.t});
  time.child("DataArray").append_attribute("NumberOfTuples") = 1;
  add_field_data(time, frame.forces);
  pugi::xml_node piece = poly.append_child("Piece");
  piece.append_attribute("NumberOfPoints") = static_cast<unsigned long long>(frame.positions.size());
  piece.append_attribute("NumberOfVerts") = static_cast<unsigned long long>(loose.size());
  piece.append_attribute("NumberOfLines") = static_cast<unsigned long long>(scene.rods.size());
  piece.append_attribute("NumberOfStrips") = 0;
  piece.append_attribute("NumberOfPolys") = 0;
  add_point_data(piece, scene, frame);
  add_cell_data(piece, scene, frame, loose);
  add_vectors(piece.append_child("Points"), "Points", frame.positions);
  add_cells(piece, "Verts", loose, 1);
  add_cells(piece, "Lines", ends, 2);
  return text_of(document);
}

VtkSeries::VtkSeries(std::filesystem::path folder, const Scene& scene)
    : folder_(std::move(folder)), scene_(scene) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw InputError("cannot make the folder " + folder_.string() + ": " + error.message());
}

void VtkSeries::add(const scenes::RunFrame& frame) {
  scenes::write_file(folder_ / frame_name(times_.size()), vtp_text(scene_, frame));
  times_.push_back(frame.t);
}

void VtkSeries::finish() {
  pugi::xml_document document;
  pugi::xml_node collection = add_file(document, "Collection").append_child("Collection");
  for (std::size_t i = 0; i < times_.size(); ++i) {
    std::string time;
    scenes::append_exact(time, times_[i]);
    pugi::xml_node set = collection.append_child("DataSet");
    set.append_attribute("timestep") = time.c_str();
    set.append_attribute("group") = "";
    set.append_attribute("part") = 0;
    set.append_attribute("file") = frame_name(i).c_str();
  }
  scenes::write_file(folder_ / "run.pvd", text_of(document));
}

}  // namespace plumb::tools
