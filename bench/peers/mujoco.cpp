// This file measures MuJoCo: bodies on ball joints in joint coordinates, without contacts, limits or other
// constraints.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "peer.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::bench {
namespace {

/// One file nests bodies this deep at most. The XML reader refuses what is nested more than 100 deep (500 in
/// other versions), so long chains go on in a file that is included.
constexpr std::size_t deepest = 64;

/// Returns what a link turns with about its particle, in kg·m².
///
/// MuJoCo factorises the mass matrix of all joints. The inertias of all that hangs on a joint are subtracted
/// from each other there. The little that bead_inertia() leaves about a rod's axis must stand out from their
/// rounding.
double standing_out(const Link& link, double largest_inertia) {
  return std::max(bead_inertia(link), 1e-13 * largest_inertia);
}

/// Returns a bound on what is subtracted, as if all masses were as far from the root as rods reach.
double largest_inertia(const Model& model) {
  std::vector<double> reach(model.links.size());
  double most = 0, mass = 0;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    reach[i] =
        norm(link.offset) + (link.parent == Link::none ? 0 : reach[static_cast<std::size_t>(link.parent)]);
    most = std::max(most, reach[i]);
    mass += link.mass;
  }
  return mass * most * most;
}

/// Throws MuJoCo's error. MuJoCo would otherwise end the program.
void throw_error(const char* text) {
  throw std::runtime_error(std::string("MuJoCo: ") + text);
}
/// Does nothing. Warnings are counted in mjData; by default they also go to a file in the current folder.
void ignore_warning(const char*) {}

std::string numbers(std::initializer_list<double> values) {
  std::string out;
  for (const double value : values) {
    if (!out.empty()) out += ' ';
    scenes::append_exact(out, value);
  }
  return out;
}
std::string numbers(const Vec3& v) {
  return numbers({v.x, v.y, v.z});
}

std::string file_name(std::size_t number) {
  return "part" + std::to_string(number) + ".xml";
}

/// Describes the scene as MuJoCo's XML. The first file holds all, or includes the others.
class Description {
 public:
  Description(const Model& model, const std::string& integrator, double dt)
      : model_(model), largest_inertia_(largest_inertia(model)) {
    children_.resize(model.links.size());
    files_.emplace_back();
    std::string text = "<mujoco><compiler inertiafromgeom=\"false\"/><option integrator=\"" + integrator +
                       "\" timestep=\"" + numbers({dt}) + "\" gravity=\"" + numbers(model.scene.gravity) +
                       "\"/><worldbody>";
    for (std::size_t i = 0; i < model.links.size(); ++i)
      if (model.links[i].parent != Link::none)
        children_[static_cast<std::size_t>(model.links[i].parent)].push_back(i);
    for (std::size_t i = 0; i < model.links.size(); ++i)
      if (model.links[i].parent == Link::none) append_body(text, i, 0);
    files_[0] = text + "</worldbody></mujoco>";
  }

  const std::vector<std::string>& files() const { return files_; }

 private:
  /// Appends a body. Its frame has its origin at its joint, where the parent's particle is.
  void append_body(std::string& text, std::size_t i, std::size_t depth) {
    if (depth > 0 && depth % deepest == 0) {
      const std::size_t number = files_.size();
      files_.emplace_back();
      std::string part = "<mujoco>";
      append_contents(part, i, depth);
      files_[number] = part + "</mujoco>";
      text += "<include file=\"" + file_name(number) + "\"/>";
      return;
    }
    append_contents(text, i, depth);
  }

  void append_contents(std::string& text, std::size_t i, std::size_t depth) {
    const Link& link = model_.links[i];
    const Vec3 joint = link.parent == Link::none ? model_.scene.particles[link.root].position
                                                 : model_.links[static_cast<std::size_t>(link.parent)].offset;
    const double inertia = standing_out(link, largest_inertia_);
    text += "<body pos=\"" + numbers(joint) + "\"><joint type=\"ball\"/><inertial pos=\"" +
            numbers(link.offset) + "\" mass=\"" + numbers({link.mass}) + "\" diaginertia=\"" +
            numbers({inertia, inertia, inertia}) + "\"/>";
    for (const std::size_t child : children_[i]) append_body(text, child, depth + 1);
    text += "</body>";
  }

  const Model& model_;
  double largest_inertia_;
  std::vector<std::vector<std::size_t>> children_;
  std::vector<std::string> files_;
};

struct Deleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

std::unique_ptr<mjModel, Deleter> load(const Description& description) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  for (std::size_t i = 0; i < description.files().size(); ++i) {
    const std::string& text = description.files()[i];
    if (mj_makeEmptyFileVFS(files.get(), file_name(i).c_str(), static_cast<int>(text.size())) != 0)
      throw std::runtime_error("MuJoCo: no room for a file");
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), file_name(i).c_str())], text.data(), text.size());
  }
  char error[1000] = "";
  std::unique_ptr<mjModel, Deleter> model(mj_loadXML(file_name(0).c_str(), files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

/// Returns the particles of MuJoCo's bodies but the first, which is the world. MuJoCo's own order is depth
/// first.
std::vector<std::uint32_t> body_particles(const Model& model) {
  std::vector<std::vector<std::size_t>> children(model.links.size());
  std::vector<std::size_t> open;
  for (std::size_t k = model.links.size(); k-- > 0;) {
    if (model.links[k].parent == Link::none)
      open.push_back(k);
    else
      children[static_cast<std::size_t>(model.links[k].parent)].push_back(k);
  }
  std::vector<std::uint32_t> out;
  while (!open.empty()) {
    const std::size_t i = open.back();
    open.pop_back();
    out.push_back(model.links[i].particle);
    open.insert(open.end(), children[i].begin(), children[i].end());
  }
  return out;
}

class MuJoCo : public Peer {
 public:
  MuJoCo(const Model& model, const std::string& integrator, std::uint32_t steps)
      : steps_(steps), particles_(body_particles(model)) {
    mju_user_error = throw_error;
    mju_user_warning = ignore_warning;
    model_ = load(Description(model, integrator, 1.0 / frames_per_second / steps));
    data_.reset(mj_makeData(model_.get()));
    if (!data_) throw std::runtime_error("MuJoCo: no memory");
  }

  void step_frame() override {
    for (std::uint32_t step = 0; step < steps_; ++step) mj_step(model_.get(), data_.get());
    // MuJoCo puts a state that is not finite back to the start, with a warning.
    for (const int warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (data_->warning[warning].number > 0) throw std::runtime_error("MuJoCo: the state is not finite");
  }

  void copy_state(Frame& frame) override {
    // After a step these values are still those of its beginning.
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_comVel(model_.get(), data_.get());
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const int body = static_cast<int>(i) + 1;
      const mjtNum* x = data_->xipos + 3 * body;
      mjtNum v[6];
      mj_objectVelocity(model_.get(), data_.get(), mjOBJ_BODY, body, v, 0);
      frame.positions[particles_[i]] = {x[0], x[1], x[2]};
      frame.velocities[particles_[i]] = {v[3], v[4], v[5]};
    }
  }

 private:
  std::uint32_t steps_;
  std::vector<std::uint32_t> particles_;
  std::unique_ptr<mjModel, Deleter> model_;
  std::unique_ptr<mjData, Deleter> data_;
};

}  // namespace

PeerFamily mujoco_family() {
  // MuJoCo's mass matrix has an entry for every link and each that it hangs from. One frame of a chain of
  // 1000 rods takes minutes, set-up included.
  PeerFamily family{.name = "MuJoCo", .must_reach = 1e-5, .most_links = 300};
  for (const std::string integrator : {"Euler", "implicit", "RK4"})
    family.paths.push_back(
        halving_path("MuJoCo " + integrator, "",
                     [integrator](const Model& model, std::uint32_t steps) -> std::unique_ptr<Peer> {
                       return std::make_unique<MuJoCo>(model, integrator, steps);
                     }));
  return family;
}

}  // namespace plumb::bench
