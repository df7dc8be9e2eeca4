#include "solver/step/internal_damping.hpp"

namespace rodsweep {

InternalDamping::InternalDamping(Rod& rod, double tau_s) : tau_s_(tau_s), now_(rod) {
  rod.damping.assign(rod.joints.size(), {});
}

void InternalDamping::remember(const Rod& rod) {
  before_ = now_.constraint;
  linearize(rod, now_);
}

void InternalDamping::start(Rod& rod, double h, bool two_steps) const {
  const double yielding = 1 / (1 + tau_s_ / h);
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Eigen::Index row = static_cast<Eigen::Index>(6 * k);
    const Vector6 now = now_.constraint.segment<6>(row), before = before_.segment<6>(row);
    JointDamping& damping = rod.damping[k];
    damping.yielding.setConstant(yielding);
    damping.past = (1 - yielding) * (two_steps ? Vector6((4 * now - before) / 3) : now);
    if (!rod.joints[k].is_inextensible) continue;
    damping.yielding.head<3>().setOnes();
    damping.past.head<3>().setZero();
  }
}

}  // namespace rodsweep
