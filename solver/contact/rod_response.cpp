#include "solver/contact/rod_response.hpp"

#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {

RodResponse::RodResponse(const Rod& rod)
    : system_(rod),
      factor_(system_.matrix(), root_to_leaf_order(rod)),
      change_(6 * rod.joint_count()),
      multipliers_(6 * rod.joint_count()) {}

void RodResponse::assemble(const Rod& rod, double dt) {
  multipliers_.setZero();
  system_.assemble(rod, dt);
  factor_.factorise(system_.matrix());
}

void RodResponse::respond(const Rod& rod, Lane8* motion) {
  const Linearization& linearization = system_.linearization();
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    store6(change_.data() + 6 * k, constraint_change(linearization.joints[k], motion[joint.a], motion[joint.b]));
  }
  factor_.substitute(change_);
  multipliers_ -= change_;
  system_.displacements(rod, change_, taken_back_);
  for (std::size_t s = 0; s < rod.segments.size(); ++s) motion[s] -= taken_back_[s];
}

}  // namespace rodsweep
