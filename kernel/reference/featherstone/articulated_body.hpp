#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "plumb/inertia.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {

/// Names what a joint lets a link do relative to its parent, and the coordinates that say so.
///
/// - revolute: The link turns about an axis, by an angle (rad).
/// - prismatic: The link slides along an axis, by a distance (m).
/// - spherical: The link turns about a point. Coordinates are its orientation in space, as a unit quaternion
///   w, x, y, z. Speeds are its angular velocity in space (1/s), not relative to the parent.
/// - translation: The link shifts without turning, by three distances (m), only on the base. With a spherical
///   link on a translation without mass, the base floats.
enum class Joint : std::uint8_t { revolute, prismatic, spherical, translation };

/// Describes a rigid link. Its frame has its origin in its joint. The frame is turned as the parent's when a
/// revolute or prismatic joint is at zero, and as space when the parent is the base.
struct Link {
  static constexpr std::uint32_t base = 0xffffffff;

  std::uint32_t parent = base;  ///< The parent is a link with a smaller number, or the base.
  Joint joint = Joint::spherical;
  Vec3 place{};        ///< Place of the joint in the parent's frame, in m.
  Vec3 axis{1, 0, 0};  ///< Unit axis of a revolute or prismatic joint, in the parent's frame.
  double mass = 0;     ///< Mass, in kg.
  Vec3 center{};       ///< Centre of mass in the link's frame, in m.
  Inertia inertia{};   ///< About the centre of mass, in the link's frame, in kg m².
  Vec3 grip{};         ///< Where a force on the link acts, in the link's frame, in m.
};

/// Says what acts on an articulated body.
struct BodyLoad {
  Vec3 gravity{};                  ///< Gravity, in m/s².
  Vec3 base_acceleration{};        ///< Acceleration of the base, in m/s².
  std::span<const Vec3> forces{};  ///< Force at every link's grip, in space, in N; empty for none.
  /// Further moments on every link that is not a rod, about its joint, in space, in N m; empty for none.
  std::span<const Vec3> moments{};
  std::span<const double>
      torques{};  ///< N m about joints (a spherical one in space), or N; one for each speed
};

/// Says how a link moves, in space.
struct LinkMotion {
  Vec3 position;          ///< Position of its joint, in m.
  Vec3 velocity;          ///< Velocity of its joint, in m/s.
  Vec3 angular_velocity;  ///< Angular velocity, in 1/s.
  Mat3 rotation;          ///< Takes vectors from its frame to space.
};

/// Moves a tree of rigid links in reduced coordinates (thesis §3.5). The articulated-body algorithm finds
/// accelerations in linear time (Featherstone 1983; Rigid Body Dynamics Algorithms, 2008, table 7.1). All
/// vectors are in the axes of space and about each link's own joint.
///
/// A slender link has no inertia about its own axis. If all that hangs from it hangs by spherical joints on
/// that axis, nothing turns about it. Its spherical joint then has two freedoms, across the axis, and the
/// link does not spin.
///
/// Slender links along their own x, which carry everything at one point, take a shorter way. They hand on
/// only a 3x3 articulated mass at the joint.
class ArticulatedBody {
 public:
  /// Takes the links. Throws std::invalid_argument on a parent that does not come before its link, or a
  /// translation that is not on the base.
  explicit ArticulatedBody(Array<Link> links);

  std::uint32_t links() const { return static_cast<std::uint32_t>(links_.size()); }
  Eigen::Index coordinates() const { return coordinates_; }
  Eigen::Index speeds() const { return speeds_; }
  bool is_spherical(std::uint32_t link) const { return links_[link].joint == Joint::spherical; }
  Eigen::Index coordinate(std::uint32_t link) const {
    return nodes_[link].q;
  }                                                                        ///< first coordinate of a link
  Eigen::Index speed(std::uint32_t link) const { return nodes_[link].v; }  ///< first speed of a link

  /// Computes the rates of the speeds. It allocates nothing once `out` has its size.
  void accelerations(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const BodyLoad& load,
                     Eigen::VectorXd& out);
  /// Computes the rates of the coordinates.
  void rates(const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& out) const;
  /// Takes rounding and truncation out of what is not free: the lengths of quaternions, and the spin of links
  /// with two freedoms.
  void settle(Eigen::VectorXd& q, Eigen::VectorXd& v) const;
  /// Says how every link moves, by its number; `out` has links() elements.
  void motions(const Eigen::VectorXd& q, const Eigen::VectorXd& v, Vec3 base_position, Vec3 base_velocity,
               std::span<LinkMotion> out) const;

 private:
  static constexpr std::uint32_t none = 0xffffffff;

  /// Holds what the passes read of every link. For a rod that is its mass, its first and second moment about
  /// the joint along the rod, and how far the tip is.
  struct Node {
    double mass, first, second, tip;
    std::uint32_t q, v;
    std::uint32_t parent;
    std::uint32_t slot;     ///< place where children of a rod leave their part if they do not follow at once
    std::uint32_t general;  ///< number of the general link; none for a rod
    Joint joint;
    bool follows;  ///< this is a rod whose parent is the rod just before it
  };
  /// Holds inertia and bias force as felt at a point that turns nothing: f = mass a + force.
  struct PointLoad {
    Sym3 mass;
    Vec3 force;
  };
  /// Holds what is felt at a link's joint that accelerates by A and turns by Omega. The force is m A + bᵀ
  /// Omega + f, the torque b A + a Omega + n.
  struct Articulated {
    Sym3 a;
    Mat3 b;
    Sym3 m;
    Vec3 n, f;
  };
  /// This is where children of a rod leave their part, and find its acceleration.
  struct Slot {
    PointLoad load;
    Vec3 acceleration;
  };
  /// Holds beta = w a + w0, which says how a rod's direction accelerates, apart from turning.
  struct RodWork {
    Vec3 u;
    double speed2;  ///< squared speed of the direction, 1/s²
    Mat3 w;
    Vec3 w0;
  };
  struct General {
    Mat3 rotation{};
    Vec3 angular_velocity{};
    Vec3 arm{};                ///< vector from the parent's joint, m
    Vec3 turn_bias{}, bias{};  ///< parts of accelerations that come from velocities
    Vec3 axis{};               ///< axis of a revolute or prismatic joint in space, or of a slender link
    Articulated articulated{};
    Vec3 un{}, uf{};              ///< inertia times the joint's motion
    double over = 0, torque = 0;  ///< 1 / the joint's inertia; what is left of the force on the joint
    Sym3 h{};                     ///< inverse of a, for a spherical joint
    Vec3 acceleration{}, angular_acceleration{};
    Vec3 slender{};  ///< axis across which there are two freedoms, in the link's frame; zero if there are
                     ///< three
  };

  void find_kinds();
  bool is_rod(std::uint32_t link) const;
  bool is_slender(std::uint32_t link, Vec3& axis) const;
  void place_general(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  void start_general(General& general, const Link& link, Vec3 force, Vec3 moment) const;
  void eliminate_general(std::uint32_t link, const BodyLoad& load);
  void add_child(General& parent, const Articulated& child, Vec3 arm, Vec3 turn_bias, Vec3 bias) const;
  /// Eliminates a rod whose tip carries `tip`. Returns what its joint feels.
  PointLoad eliminate_rod(std::uint32_t link, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                          const BodyLoad& load, const PointLoad& tip);
  void eliminate(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const BodyLoad& load);
  void accelerate(const BodyLoad& load, double* rates);
  void hand_on(std::uint32_t link, const PointLoad& load);
  void accelerate_general(std::uint32_t link, const BodyLoad& load, double* out);
  Vec3 joint_acceleration(std::uint32_t link, Vec3 base) const;

  Array<Link> links_;
  Array<Node> nodes_;
  Array<General> general_;
  Array<std::uint32_t> general_links_;
  Array<Slot> slots_;
  Array<RodWork> rods_;  ///< by link's number
  Eigen::Index coordinates_ = 0, speeds_ = 0;
};

}  // namespace plumb::detail
