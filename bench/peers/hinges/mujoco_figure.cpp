// MuJoCo's model of the figure: a free joint and hinges. Nothing is damped, touches or is limited.
#include <mujoco/mujoco.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "run.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::bench {
namespace {

std::string numbers(const Vec3& v) {
  std::string out;
  for (const double value : {v.x, v.y, v.z}) {
    if (!out.empty()) out += ' ';
    scenes::append_exact(out, value);
  }
  return out;
}

/// A limb's frame has its origin at its joint.
void append_limb(std::string& text, const std::vector<Limb>& limbs, std::size_t i) {
  const Limb& limb = limbs[i];
  const bool floats = limb.parent == Limb::none;
  const Vec3 from = floats ? Vec3{} : limbs[static_cast<std::size_t>(limb.parent)].joint;
  const Inertia& inertia = limb.body.inertia;
  text += "<body pos=\"" + numbers(limb.joint - from) + "\">";
  text += floats ? "<freejoint/>" : "<joint type=\"hinge\" axis=\"" + numbers(limb.axis) + "\"/>";
  text += "<inertial pos=\"" + numbers(limb.body.center - limb.joint) + "\" mass=\"";
  scenes::append_exact(text, limb.body.mass);
  text += "\" diaginertia=\"" + numbers({inertia.xx, inertia.yy, inertia.zz}) + "\"/>";
  for (std::size_t k = i + 1; k < limbs.size(); ++k)
    if (limbs[k].parent == static_cast<std::int32_t>(i)) append_limb(text, limbs, k);
  text += "</body>";
}

std::string describe(const std::vector<Limb>& limbs, const std::string& integrator, double dt) {
  std::string text =
      "<mujoco><compiler inertiafromgeom=\"false\"/><option integrator=\"" + integrator + "\" timestep=\"";
  scenes::append_exact(text, dt);
  text += "\" gravity=\"0 0 0\"/><worldbody>";
  append_limb(text, limbs, 0);
  return text + "</worldbody></mujoco>";
}

struct Deleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

std::unique_ptr<mjModel, Deleter> load(const std::string& text) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), "figure.xml", static_cast<int>(text.size())) != 0)
    throw std::runtime_error("MuJoCo: no room for a file");
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), "figure.xml")], text.data(), text.size());
  char error[1000] = "";
  std::unique_ptr<mjModel, Deleter> model(mj_loadXML("figure.xml", files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

/// Limbs in MuJoCo's order, which is depth first.
void append_order(std::vector<std::size_t>& order, const std::vector<Limb>& limbs, std::size_t i) {
  order.push_back(i);
  for (std::size_t k = i + 1; k < limbs.size(); ++k)
    if (limbs[k].parent == static_cast<std::int32_t>(i)) append_order(order, limbs, k);
}

}  // namespace

std::string mujoco_version() {
  return mj_versionString();
}

Outcome run_mujoco(const std::vector<Limb>& limbs, const std::string& integrator, std::uint32_t steps) {
  const auto model = load(describe(limbs, integrator, duration / steps));
  const std::unique_ptr<mjData, Deleter> data(mj_makeData(model.get()));
  if (!data) throw std::runtime_error("MuJoCo: no memory");
  std::vector<std::size_t> order;
  append_order(order, limbs, 0);
  const Motion start = motions_of(limbs).front();
  // All axes are those of space as it starts.
  const double first[] = {start.velocity.x, start.velocity.y, start.velocity.z,
                          start.spin.x,     start.spin.y,     start.spin.z};
  std::copy(std::begin(first), std::end(first), data->qvel);
  for (std::size_t k = 1; k < order.size(); ++k) data->qvel[5 + k] = limbs[order[k]].rate;

  const auto before = std::chrono::steady_clock::now();
  for (std::uint32_t step = 0; step < steps; ++step) mj_step(model.get(), data.get());
  Outcome out;
  out.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
  for (const int warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
    if (data->warning[warning].number > 0) throw std::runtime_error("MuJoCo: the state is not finite");
  mj_kinematics(model.get(), data.get());
  out.centers.resize(limbs.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const mjtNum* const x = data->xipos + 3 * (k + 1);
    out.centers[order[k]] = {x[0], x[1], x[2]};
  }
  return out;
}

}  // namespace plumb::bench
