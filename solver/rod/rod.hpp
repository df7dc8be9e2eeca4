// A rod: n rigid cylindrical segments (graph nodes) joined by m joints (graph edges), its mass properties and its
// state.
//
// Segment: a prism along its local z, mass m = rho A L, principal inertia rho (Ix + Iy) L (axial) and m L^2 / 12 +
// rho (Ix + Iy) L / 2 (transverse: the mean of both axes). By default it is a solid cylinder of its radius, which is
// also that of contacts and drag. A static segment has zero inverse mass and inertia; it may have zero length (a wall).
// Joint between a and b: the point centre_a + R_a arm_a = centre_b + R_b arm_b; length l, the mean of the two segments'
// lengths. Its frame coincides at rest with q_a p_a = q_b p_b, as given or half-way between those of its segments: with
// d0 = conj(q_a) q_b at rest, split into a swing of the axis and a twist about it, d0 = s w, p_a = s^(1/2) w^(1/2) and
// p_b = conj(d0) p_a. Its z axis is half-way between those of the segments, whatever the twist. In it are the six rows
// and their compliance alpha (linearization.hpp).
// Any graph is accepted: chains, trees (several joints on a segment), loops. Throws SceneError.
#pragma once

#include <optional>
#include <stdexcept>
#include <vector>

#include "solver/numbers/types.hpp"
#include "solver/rod/cross_section.hpp"

namespace rodsweep {

/// A scene that cannot be built or simulated; the text names the quantity, its value and the bound.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws SceneError "QUANTITY is VALUE; must be BOUND" unless `holds`.
void require(bool holds, const char* quantity, double value, const char* bound);

struct SegmentSpec {
  Vector3 position_m{0, 0, 0};
  Quaternion orientation = Quaternion::Identity();
  double length_m = 0;
  double radius_m = 0;
  double density_kg_m3 = 0;
  bool is_static = false;
  std::optional<CrossSection> section{};  ///< empty: a solid circle

  CrossSection cross_section() const { return section ? *section : circle(radius_m, 0); }
  double mass() const { return density_kg_m3 * cross_section().area_m2 * length_m; }
};

struct JointSpec {
  int a = 0, b = 0;                            ///< segments
  Vector3 arm_a_m{0, 0, 0}, arm_b_m{0, 0, 0};  ///< from the segments' centres to the shared point, local frames
  Vector6 compliance_per_j = Vector6::Zero();  ///< stretch-shear rows, then bend-twist rows
  std::optional<Quaternion> rest{};            ///< d0; empty: from the initial orientations
  std::optional<Quaternion> frame{};           ///< p_a; empty: half-way
};

struct Segment {
  double length_m, radius_m, density_kg_m3;
  double mass;                                                             ///< [kg]
  double inertia_transverse, inertia_axial;                                ///< [kg m^2]
  double inverse_mass, inverse_inertia_transverse, inverse_inertia_axial;  ///< all zero if static
  bool is_static;
  double turn_mobility;  ///< of rotations across the axis, in A: inverse_inertia_transverse, or stiffened in a Newton
                         ///< iteration that keeps the balance of momentum (momentum_balance.hpp)
};

struct Joint {
  int a, b;
  Vector3 arm_a, arm_b;
  double length;                 ///< l [m]
  Vector6 compliance;            ///< alpha [1/J]: across the rod (2), along it, bending about x and y, twisting
  Quaternion frame_a, frame_b;   ///< p_a, p_b
  bool is_inextensible = false;  ///< the compliance of its stretch-shear rows is no material's: it bounds their opening

  Quaternion rest() const { return frame_a * frame_b.conjugate(); }  ///< d0
  bool is_kinked() const;                                            ///< not p_a = p_b = 1
};

/// Internal damping of a joint in a step (solver/step/internal_damping.hpp): its constraint is C - past + yielding alpha~
/// lambda = 0.
struct JointDamping {
  Vector6 yielding = Vector6::Ones(), past = Vector6::Zero();
};

/// Sets the rest orientation and the frame half-way.
void set_rest(Joint& joint, const Quaternion& rest);

class Rod {
 public:
  Rod(const std::vector<SegmentSpec>& segments, const std::vector<JointSpec>& joints);

  int segment_count() const { return static_cast<int>(segments.size()); }
  int joint_count() const { return static_cast<int>(joints.size()); }

  // Constants.
  std::vector<Segment> segments;
  std::vector<Joint> joints;

  // State, one entry per segment; lambda six per joint.
  std::vector<Vector3> position, velocity, angular_velocity;
  std::vector<Quaternion> orientation;
  VectorX lambda;
  double constraint_dt = 0;  ///< [s] of the last step: forces are J^T lambda over its square (time_step.hpp)

  // For the step: p*, the poses of segments without joints, contacts and, in balance, torques of point loads. Impulses
  // of contacts: force and torque about the centre, in the world, times constraint_dt^2; empty without contact. Torques
  // of point loads, in the world, in steps that keep the balance of momentum; empty without such loads.
  std::vector<Vector3> free_position;
  std::vector<Quaternion> free_orientation;
  std::vector<Vector6> contact_impulse;
  std::vector<Vector3> load_torque_nm;

  std::vector<JointDamping> damping;  ///< of joints, in this step; empty without internal damping

  /// alpha~ of a joint in this step.
  Vector6 softness(std::size_t joint, double inverse_dt2) const {
    const Vector6 undamped = inverse_dt2 * joints[joint].compliance;
    return damping.empty() ? undamped : Vector6(undamped.cwiseProduct(damping[joint].yielding));
  }
  /// C + alpha~ lambda of a joint, which Newton drives to zero.
  Vector6 residual(std::size_t joint, const Vector6& constraint, double inverse_dt2) const {
    const Vector6 yielded =
        softness(joint, inverse_dt2).cwiseProduct(lambda.segment<6>(static_cast<Eigen::Index>(6 * joint)));
    return damping.empty() ? Vector6(constraint + yielded) : Vector6(constraint - damping[joint].past + yielded);
  }
  bool has_outer_impulses() const { return !contact_impulse.empty() || !load_torque_nm.empty(); }
  Vector6 outer_impulse(std::size_t segment) const;  ///< of contacts and of those torques
};

/// One end of a joint, on a segment.
struct JointEnd {
  int joint;
  bool is_b;
};

/// Of every segment the joints on it, in their order.
std::vector<std::vector<JointEnd>> joints_by_segment(const Rod& rod);

/// Throws SceneError for a joint between two static segments.
void refuse_static_joints(const Rod& rod);

}  // namespace rodsweep
