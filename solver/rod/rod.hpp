// A rod: n rigid cylindrical segments (graph nodes) joined by m joints (graph edges), its mass properties and its
// state.
//
// Segment: solid cylinder along its local z, mass m = rho pi r^2 L, principal inertia m (3 r^2 + L^2) / 12 (transverse)
// and m r^2 / 2 (axial). A static segment has zero inverse mass and inertia; it may have zero length (a wall). Joint
// between a and b: the point centre_a + R_a arm_a = centre_b + R_b arm_b; length l, the mean of the two segments'
// lengths. Its frame coincides at rest with q_a p_a = q_b p_b: half-way between those of its segments, p_a = d0^(1/2),
// p_b = conj(p_a), d0 = conj(q_a) q_b at rest, or as given. In it are the six rows and their compliance alpha
// (linearization.hpp).
// Any graph is accepted: chains, trees (several joints on a segment), loops. Throws SceneError.
#pragma once

#include <optional>
#include <stdexcept>
#include <vector>

#include "solver/numbers/types.hpp"

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
  double length;                ///< l [m]
  Vector6 compliance;           ///< alpha [1/J]: across the rod (2), along it, bending about x and y, twisting
  Quaternion frame_a, frame_b;  ///< p_a, p_b

  Quaternion rest() const { return frame_a * frame_b.conjugate(); }  ///< d0
  bool is_kinked() const;                                            ///< not p_a = p_b = 1
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

  // For the step: the positions p* of segments without joints and contacts, and the impulses of contacts on them: force
  // and torque about the centre, in the world, times constraint_dt^2; empty without contact.
  std::vector<Vector3> free_position;
  std::vector<Quaternion> free_orientation;
  std::vector<Vector6> contact_impulse;
};

/// Throws SceneError for a joint between two static segments.
void refuse_static_joints(const Rod& rod);

/// The stiffness of a cross-section, in the segments' local frames.
struct Section {
  double bending_x_nm2, bending_y_nm2;  ///< EI about the local x and y axis
  double torsion_nm2;                   ///< GJ
  double axial_n, shear_n;              ///< EA, kappa G A
};

/// Half axes along local x and y. EI = E pi a b^3 / 4 and so on, GJ = G pi a^3 b^3 / (a^2 + b^2) (Saint-Venant).
Section elliptic_section(double half_axis_x_m, double half_axis_y_m, double youngs_modulus_pa,
                         double torsion_modulus_pa);
Section circular_section(double radius_m, double youngs_modulus_pa, double torsion_modulus_pa);

/// kappa = (6 + 12 nu + 6 nu^2) / (7 + 12 nu + 4 nu^2) of a circular cross-section (Timoshenko 1922; Kaneko 1975),
/// where nu = E / 2G - 1 is limited to 0 .. 1/2, because E and G are independent parameters.
double shear_coefficient(double youngs_modulus_pa, double torsion_modulus_pa);

/// Compliance of a joint: `stretch` for the three stretch-shear rows, or physical stretch, 1 / (kappa G A l) across the
/// rod and 1 / (E A l) along it; and bend-twist compliance (l/EI, l/EI, l/GJ).
Vector6 joint_compliance(double length_m, const Section& section, double stretch_per_j);
Vector6 joint_compliance(double length_m, double radius_m, double youngs_modulus_pa, double torsion_modulus_pa,
                         double stretch_per_j);

Vector6 physical_compliance(double length_m, const Section& section);

/// The default "inextensible" compliance: a joint under the force F stretches by 1e-7 of its length l: 1e-7 / (l F).
double inextensible_compliance(double joint_length_m, double force_n);

}  // namespace rodsweep
