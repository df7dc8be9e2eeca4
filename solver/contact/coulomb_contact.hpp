// The law of one contact, at one point of two bodies with the inverse effective mass W = J M^-1 J^T (3x3) there, in the
// contact's frame: the normal, then two directions across it.
//
//   gap >= 0,  lambda_n >= 0,  gap lambda_n = 0
//   |lambda_t| <= mu lambda_n;  the slip is 0, or against |lambda_t| = mu lambda_n
//
// A relaxation updates the normal part first, then friction (Jean 1999): the friction that stops the slip, if it is
// within the cone, else a step of projected gradient descent. Its step size is that of the larger eigenvalue of W
// across the normal. It is safe in every direction, also if a body rolls much more easily than it slides.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver/numbers/types.hpp"

namespace rodsweep {

/// The frame of a contact with this unit normal; columns.
inline Matrix3 contact_frame(const Vector3& normal) {
  Matrix3 frame;
  frame.col(0) = normal;
  frame.col(1) = normal.unitOrthogonal();
  frame.col(2) = normal.cross(frame.col(1));
  return frame;
}

class CoulombContact {
 public:
  CoulombContact() = default;
  /// `mobility`: W [1/kg]; `friction`: mu.
  CoulombContact(const Matrix3& mobility, double friction)
      : friction_(friction), normal_weight_(mobility(0, 0)), by_normal_{mobility(1, 0), mobility(2, 0)} {
    const double yy = mobility(1, 1), yz = mobility(1, 2), zz = mobility(2, 2), determinant = yy * zz - yz * yz;
    stick_[0] = zz / determinant;
    stick_[1] = -yz / determinant;
    stick_[2] = yy / determinant;
    sliding_weight_ = (yy + zz) / 2 + std::hypot((yy - zz) / 2, yz);
    stop_ = 1 / normal_weight_;
    slide_ = 1 / sliding_weight_;
  }

  /// The new impulse, from the impulse so far and what remains with it: the gap (negative: overlap) and the slip.
  Vector3 relaxed(const Vector3& impulse, const Vector3& gap_and_slip) const {
    const double normal = std::max(0.0, impulse.x() - stop_ * gap_and_slip.x());
    const double most = friction_ * normal, pressed = normal - impulse.x();
    if (!(most > 0)) return {normal, 0, 0};
    const double y = gap_and_slip.y() + pressed * by_normal_[0], z = gap_and_slip.z() + pressed * by_normal_[1];
    const double stuck_y = impulse.y() - stick_[0] * y - stick_[1] * z,
                 stuck_z = impulse.z() - stick_[1] * y - stick_[2] * z;
    if (stuck_y * stuck_y + stuck_z * stuck_z <= most * most) return {normal, stuck_y, stuck_z};
    return limited({normal, impulse.y() - slide_ * y, impulse.z() - slide_ * z}, most);
  }

  /// The projection into the friction cone: the normal part, and the friction that it allows.
  Vector3 admissible(const Vector3& impulse) const {
    return impulse.x() > 0 ? limited(impulse, friction_ * impulse.x()) : Vector3(0, 0, 0);
  }

  /// An upper bound of the motion by an impulse, up to the coupling of normal and friction [m].
  double motion(const Vector3& impulse) const {
    return normal_weight_ * std::abs(impulse.x()) + sliding_weight_ * size(impulse.y(), impulse.z());
  }

  /// n . W n [1/kg]
  double normal_weight() const { return normal_weight_; }

 private:
  static double size(double y, double z) { return std::sqrt(y * y + z * z); }
  static Vector3 limited(const Vector3& impulse, double most) {
    const double friction = size(impulse.y(), impulse.z());
    const double share = friction > most ? most / friction : 1;
    return {impulse.x(), share * impulse.y(), share * impulse.z()};
  }

  double friction_ = 0;
  double normal_weight_ = 0;
  double by_normal_[2] = {};   ///< W n across the normal: the slip by a normal impulse [1/kg]
  double sliding_weight_ = 0;  ///< the larger eigenvalue of W across the normal [1/kg]
  double stop_ = 0;            ///< inverse of the normal weight [kg]
  double slide_ = 0;           ///< inverse of the sliding weight [kg]
  double stick_[3] = {};       ///< the inverse of W across the normal: yy, yz, zz [kg]
};

}  // namespace rodsweep
