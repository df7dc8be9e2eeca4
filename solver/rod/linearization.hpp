// Constraints and their Jacobians of every joint of a rod at its current positions, in the rod's own (material) frames.
//
//   bend-twist     C_b = 2 Im(e),  e = conj(q_a p_a) q_b p_b = (w, v), w >= 0
//   stretch-shear  C_s = R_m^T (x_a + R_a arm_a - x_b - R_b arm_b) / l,   R_m = R_a P_a H = R_b P_b H^T
// P = R(p): the frames q_a p_a and q_b p_b coincide at rest (rod.hpp), so e is the joint's rotation from rest. The
// joint's frame R_m is half-way between them, H = R(e^(1/2)) = w I + [v]x + v v^T / (1 + w). Exchanging the segments
// gives the same frame. On a straight rod p_a = p_b = 1, and C_b is l times the Darboux vector (2/l) Im(d) with d =
// conj(q_a) q_b (Kugelstadt & Schoemer 2016; Deul et al. 2018, who measure the gap in the world). Their measure
// 2 Im(d) - 2 Im(d0) of a joint with rest angle theta changes by only cos(theta / 2) of a rotation about d0's axis.
//
// Segments move by u and turn by phi, both in their own frame: dx = R u, q <- normalise(q (1 + [0, phi] / 2)). Then
//   dC_s/du_a =  H^T P_a^T / l,   dC_s/dphi_a = -H^T P_a^T [arm_a]x / l,   dC_b/dphi_a = -(w I - [v]x) P_a^T
//   dC_s/du_b = -H P_b^T / l,     dC_s/dphi_b =  H P_b^T [arm_b]x / l,     dC_b/dphi_b =  (w I + [v]x) P_b^T
// depend on e alone: J and C do not depend on the position and orientation of a scene. J neglects that R_m turns with
// the segments: that term is proportional to the gap, and without it Newton's iterates are those of C_s in the world.
#pragma once

#include <memory>
#include <vector>

#include "solver/numbers/lanes.hpp"
#include "solver/rod/joint_constraint.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// One joint's Jacobian, by columns of its two sides. dC/dphi has six rows, in the six lanes; dC/du has only those of
/// stretch-shear, in lanes 0..2.
struct JointJacobian {
  Lane8 rotation_a[3], rotation_b[3];  ///< dC/dphi
  Lane4 shift_a[3], shift_b[3];        ///< dC_s/du
  double inverse_length;               ///< 1/l [1/m]
  bool straight;                       ///< P_a = P_b = 1: shift_a is minus the transpose of shift_b
};

using JointKinks = std::vector<std::shared_ptr<const JointKink<Lane>>>;

struct Linearization {
  std::vector<JointJacobian> joints;     ///< padded to whole registers with copies of the last
  VectorX constraint;                    ///< C, six per joint
  std::vector<JointShape<Lane>> shapes;  ///< each of as many joints as a register has lanes
  JointKinks kinks;                      ///< of those that are not straight
  std::vector<JointTurn<Lane>> turns;    ///< of the same joints

  explicit Linearization(const Rod& rod);  ///< sized, not evaluated
};

/// A joint's rotation from rest: e, and the orientation q_a p_a of the frame that it is in.
struct TurnFromRest {
  Quaternion e, frame;
};
TurnFromRest turn_from_rest(const Rod& rod, const Joint& joint);

/// R_m v of a joint: from its frame to the world, and R_m^T v back.
Vector3 to_world(const Rod& rod, const Joint& joint, const Vector3& in_joint_frame);
Vector3 from_world(const Rod& rod, const Joint& joint, const Vector3& in_world);

/// One joint's Jacobian and the six values of its C at the rod's positions.
void linearize(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint);

/// Evaluates `out` at the positions of the rod that it was made for. Allocates nothing.
void linearize(const Rod& rod, Linearization& out);

}  // namespace rodsweep
