#include "solver/contact/coulomb_contact.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rodsweep {

CoulombContact::CoulombContact(const Vector3& normal, const Matrix3& mobility, double friction)
    : normal_(normal),
      friction_(friction),
      normal_weight_(normal.dot(mobility * normal)),
      by_normal_(mobility * normal) {
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = normal.unitOrthogonal();
  tangents.col(1) = normal.cross(tangents.col(0));
  const Eigen::Matrix2d w = tangents.transpose() * mobility * tangents;
  stick_ = tangents * w.inverse() * tangents.transpose();
  sliding_weight_ = w.trace() / 2 + std::hypot((w(0, 0) - w(1, 1)) / 2, w(0, 1));
}

Vector3 CoulombContact::relaxed(const Vector3& impulse, double gap, const Vector3& slip) const {
  const double normal = std::max(0.0, normal_.dot(impulse) - gap / normal_weight_);
  const double most = friction_ * normal;
  if (!(most > 0)) return normal * normal_;
  const Vector3 slips = slip + (normal - normal_.dot(impulse)) * by_normal_;
  const Vector3 before = across(impulse), stuck = before - stick_ * slips;
  if (stuck.norm() <= most) return normal * normal_ + stuck;
  const Vector3 slid = before - across(slips) / sliding_weight_;
  return normal * normal_ + std::min(1.0, most / slid.norm()) * slid;
}

Vector3 CoulombContact::admissible(const Vector3& impulse) const {
  const double normal = normal_.dot(impulse);
  if (!(normal > 0)) return Vector3::Zero();
  const Vector3 tangential = across(impulse);
  const double most = friction_ * normal, size = tangential.norm();
  return normal * normal_ + (size > most ? most / size : 1) * tangential;
}

}  // namespace rodsweep
