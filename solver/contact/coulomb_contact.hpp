// The law of one contact, at one point of two bodies with the inverse effective mass W = J M^-1 J^T (3x3) there:
//
//   gap >= 0,  lambda_n >= 0,  gap lambda_n = 0
//   |lambda_t| <= mu lambda_n;  the slip is 0, or against |lambda_t| = mu lambda_n
//
// A relaxation updates the normal part first, then friction (Jean 1999): the friction that stops the slip, if it is
// within the cone, else a step of projected gradient descent. Its step size is that of the larger eigenvalue of W
// across the normal. It is safe in every direction, also if a body rolls much more easily than it slides.
#pragma once

#include "solver/numbers/types.hpp"

namespace rodsweep {

class CoulombContact {
 public:
  CoulombContact() = default;
  /// `normal`: unit; `mobility`: W [1/kg]; `friction`: mu.
  CoulombContact(const Vector3& normal, const Matrix3& mobility, double friction);

  /// The new impulse, from the impulse so far and the gap (negative: overlap) and slip that remain with it.
  Vector3 relaxed(const Vector3& impulse, double gap, const Vector3& slip) const;

  /// The projection into the friction cone: the normal part, and the friction that it allows.
  Vector3 admissible(const Vector3& impulse) const;

  /// An upper bound of the motion by an impulse, up to the coupling of normal and friction [m].
  double motion(const Vector3& impulse) const {
    return normal_weight_ * std::abs(normal_.dot(impulse)) + sliding_weight_ * across(impulse).norm();
  }

  /// n . W n [1/kg]
  double normal_weight() const { return normal_weight_; }

 private:
  Vector3 across(const Vector3& v) const { return v - normal_.dot(v) * normal_; }

  Vector3 normal_{0, 0, 0};
  double friction_ = 0;
  double normal_weight_ = 0;
  Vector3 by_normal_{0, 0, 0};  ///< W n: the motion by a normal impulse [1/kg]
  double sliding_weight_ = 0;   ///< the larger eigenvalue of W across the normal [1/kg]
  Matrix3 stick_;               ///< the inverse of W across the normal [kg]
};

}  // namespace rodsweep
