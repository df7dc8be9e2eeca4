#include "solver/contact/rod_response.hpp"

#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {
namespace {

Lane8 turned(const Quaternion& q, const Lane8& motion) {
  const Vector3 dx = q * Vector3(motion[0], motion[1], motion[2]);
  const Vector3 dtheta = q * Vector3(motion[3], motion[4], motion[5]);
  return Lane8{dx.x(), dx.y(), dx.z(), dtheta.x(), dtheta.y(), dtheta.z(), 0, 0};
}

}  // namespace

RodResponse::RodResponse(const Rod& rod)
    : system_(rod),
      factor_(system_.matrix(), root_to_leaf_order(rod)),
      change_(6 * rod.joint_count()),
      multipliers_(6 * rod.joint_count()),
      own_(rod.segments.size()) {}

void RodResponse::assemble(const Rod& rod, double dt) {
  multipliers_.setZero();
  system_.assemble(rod, dt);
  factor_.factorise(system_.matrix());
}

void RodResponse::respond(const Rod& rod, Lane8* motion) {
  const Linearization& linearization = system_.linearization();
  for (std::size_t s = 0; s < own_.size(); ++s) own_[s] = turned(rod.orientation[s].conjugate(), motion[s]);
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    store6(change_.data() + 6 * k, constraint_change(linearization.joints[k], own_[static_cast<std::size_t>(joint.a)],
                                                     own_[static_cast<std::size_t>(joint.b)]));
  }
  factor_.substitute(change_);
  multipliers_ -= change_;
  system_.displacements(rod, change_, taken_back_);
  for (std::size_t s = 0; s < own_.size(); ++s) motion[s] -= turned(rod.orientation[s], taken_back_[s]);
}

}  // namespace rodsweep
