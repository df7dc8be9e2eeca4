// The balance of momentum over a time step, of every segment in its own frame,
//
//   g = M (p - p*) - J^T lambda - f_c - f_t
//
// and the geometric stiffness with which Newton's iteration for g = 0 converges. p - p* consists of R^T (x - x*) and
// 2 Im(d) / Re(d), d = conj(q*) q, the rotation vector that the time step's update undoes (rotation.hpp; its axis is
// the same in both frames). f_c are the contacts' impulses, f_t those of point loads' torques. (In p*, a torque would
// turn a short segment by many radians before joints hold it, and rotation vectors do not add.) With g = 0 a rod at rest
// is in equilibrium for any time step: p* - p is then M^-1 dt_c^2 times the other loads. The step of Deul et al. 2018
// and Shao et al. 2021 does not use g: there p - p* = sum_j M^-1 J_j^T dlambda_j, with J at each Newton iteration's own
// positions.
//
// Geometric stiffness K = -d(J^T lambda)/dp: the force f of a joint at its arm r gives the segment the stiffness
// (f.r) I - f r^T. Only the diagonal part across the axis is kept, the sum of (f.r) over its joints, tension times
// length on a rod: M + K stays diagonal in the segment's frame and A keeps its pattern (Tournier et al. 2015, Stable
// Constrained Dynamics; Andrews et al. 2017, Geometric Stiffness for Real-time Constrained Multibody Dynamics).
// Compression is limited to half of the inertia, so that M + K stays positive.
//
// Stretch-shear multipliers represent forces: Newton rotates the joints' frames, and balanced iterations keep the
// force, so they rotate the multipliers back. With displacements this is done to second order (turned_back). Contacts
// have no displacements and use the poses before and after (with_forces_held).
#pragma once

#include <vector>

#include "solver/rod/linearization.hpp"

namespace rodsweep {

/// Mass [kg] and principal inertia [kg m^2] of segments.
struct LaneInertia {
  Lane mass, transverse, axial;
};

struct MomentumBalance {
  std::vector<Lane8> defect;  ///< g: lanes 0..2 [kg m], 3..5 [kg m^2]; zero if static
  std::vector<Lane4> pull;    ///< per segment: sum of force times arm, by components; f.r is the sum of its lanes
  /// The largest |force| of g, or |torque| over the segment's length, relative to the largest that a joint carries. If
  /// joints carry less than what moves a segment by a millionth of its length, relative to that. 0 without joints.
  double residual = 0;

  explicit MomentumBalance(const Rod& rod);  ///< sized, not evaluated

  /// Constants of as many neighbours as a register has lanes.
  std::vector<LaneInertia> inertia;
  std::vector<double> inverse_squared_length;  ///< 1/L^2 of each segment; 0 if static
  double least;                                ///< lower limit of the residual's reference [kg m]
};

/// Evaluates `out` at the linearisation's positions. Allocates nothing.
void balance_momentum(const Rod& rod, const Linearization& at, MomentumBalance& out);

/// Sets the segments' turn_mobility to that of M + K.
void stiffen(Rod& rod, const MomentumBalance& balance);
void unstiffen(Rod& rod);  ///< resets it to that of M

/// The components of a vector that is constant in the world while its frame rotates by delta, to second order.
template <class T>
inline Triple<T> turned_back(const Triple<T>& v, const Triple<T>& delta) {
  const Triple<T> across = cross(v, delta), again = cross(across, delta);
  return {v.x + across.x + 0.5 * again.x, v.y + across.y + 0.5 * again.y, v.z + across.z + 0.5 * again.z};
}

/// Runs `move`, which moves segments, and keeps the stretch-shear forces constant in the world.
template <class Move>
void with_forces_held(Rod& rod, const Move& move) {
  const auto turn = [&rod](auto&& turned) {
    for (std::size_t k = 0; k < rod.joints.size(); ++k) {
      auto force = rod.lambda.segment<3>(static_cast<Eigen::Index>(6 * k));
      force = turned(rod, rod.joints[k], Vector3(force));
    }
  };
  turn(to_world);
  move();
  turn(from_world);
}

}  // namespace rodsweep
