#include "solver/linear/linear_system.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "solver/linear/interruption.hpp"
#include "solver/numbers/lanes.hpp"
#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {

LinearSystem::LinearSystem(const Rod& rod)
    : linearization_(rod),
      rhs_(VectorX::Zero(6 * rod.joint_count())),
      displacements_(rod.segments.size()),
      balance_(rod),
      balancing_(rod.segments.size()) {
  const std::int64_t a_third_ns = 500ll * rod.joint_count();  // with a million joints this lasts seconds
  check_interrupted(a_third_ns);
  refuse_static_joints(rod);  // their rows would be alpha~ alone, which may be zero
  std::vector<std::vector<JointEnd>> by_segment = joints_by_segment(rod);
  for (std::size_t s = 0; s < by_segment.size(); ++s)
    if (rod.segments[s].is_static) by_segment[s].clear();
  std::vector<std::pair<int, int>> couplings;
  side_start_.push_back(0);
  for (const std::vector<JointEnd>& sides : by_segment) {
    for (const JointEnd& u : sides)
      for (const JointEnd& v : sides) couplings.emplace_back(u.joint, v.joint);
    sides_.insert(sides_.end(), sides.begin(), sides.end());
    side_start_.push_back(static_cast<int>(sides_.size()));
  }
  check_interrupted(a_third_ns);
  matrix_ = BlockMatrix(rod.joint_count(), couplings);
  check_interrupted(a_third_ns);
  if (matrix_.block_count() >= ConstraintProduct::least_blocks) product_.emplace(rod);

  std::vector<bool> written(matrix_.blocks.size(), false);
  for (const std::vector<JointEnd>& sides : by_segment)
    for (const JointEnd& u : sides)
      for (const JointEnd& v : sides) {
        const int block = matrix_.find(u.joint, v.joint);
        contributions_.push_back({block, !written[at(block)]});
        written[at(block)] = true;
      }
}

void LinearSystem::assemble(const Rod& rod, double dt) {
  balanced_ = false;
  linearize(rod, linearization_);
  assemble_linearized(rod, dt);
}

void LinearSystem::assemble_balanced(Rod& rod, double dt) {
  balanced_ = true;
  linearize(rod, linearization_);
  balance_momentum(rod, linearization_, balance_);
  stiffen(rod, balance_);
  assemble_linearized(rod, dt);
  for (std::size_t s = 0; s < rod.segments.size(); ++s) balancing_[s] = motion(rod.segments[s], balance_.defect[s]);
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    double* b = rhs_.data() + 6 * k;
    store6(b, load6(b) + constraint_change(linearization_.joints[k], balancing_[at(joint.a)], balancing_[at(joint.b)]));
  }
}

void LinearSystem::assemble_linearized(const Rod& rod, double dt) {
  dt_ = dt;
  const double inverse_dt2 = 1 / (dt * dt);
  assemble_matrix(rod, inverse_dt2);
  if (product_) product_->update(rod, linearization_, inverse_dt2);
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Eigen::Index row = static_cast<Eigen::Index>(6 * k);
    rhs_.segment<6>(row) = -rod.residual(k, linearization_.constraint.segment<6>(row), inverse_dt2);
  }
  newton_residual_ = largest_rhs();
}

void LinearSystem::assemble_matrix(const Rod& rod, double inverse_dt2) {
  const Contribution* next = contributions_.data();
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    const Segment& segment = rod.segments[s];
    for (int u = side_start_[s]; u < side_start_[s + 1]; ++u) {
      const JointEnd& at_u = sides_[at(u)];
      const JointSide side_u(linearization_.joints[at(at_u.joint)], at_u.is_b);
      for (int v = side_start_[s]; v < side_start_[s + 1]; ++v, ++next) {
        const JointEnd& at_v = sides_[at(v)];
        Block6& block = matrix_.blocks[at(next->block)];
        if (u == v) {
          const Vector6 softness = rod.softness(at(at_u.joint), inverse_dt2);
          if (next->first)
            add_square<true>(side_u, segment, softness.data(), block);
          else
            add_square<false>(side_u, segment, nullptr, block);
          continue;
        }
        const JointSide side_v(linearization_.joints[at(at_v.joint)], at_v.is_b);
        if (next->first)
          add_product<true>(side_u, side_v, segment, block);
        else
          add_product<false>(side_u, side_v, segment, block);
      }
    }
  }
}

void LinearSystem::displacements(const Rod& rod, const VectorX& delta_lambda, std::vector<Lane8>& out) const {
  out.assign(rod.segments.size(), Lane8{});
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    Lane8 on_a, on_b;
    impulses(linearization_.joints[k], load6(delta_lambda.data() + 6 * k), on_a, on_b);
    out[at(joint.a)] += on_a;
    out[at(joint.b)] += on_b;
  }
  for (std::size_t s = 0; s < rod.segments.size(); ++s) out[s] = motion(rod.segments[s], out[s]);
}

void LinearSystem::apply(Rod& rod, const VectorX& delta_lambda) {
  displacements(rod, delta_lambda, displacements_);
  if (balanced_)
    for (std::size_t s = 0; s < rod.segments.size(); ++s) displacements_[s] -= balancing_[s];
  displace(rod, displacements_, delta_lambda);
  if (balanced_) hold_forces(rod);
}

void LinearSystem::hold_forces(Rod& rod) const {
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    const Lane4 delta = frame_turn(linearization_.joints[k], displacements_[at(joint.a)], displacements_[at(joint.b)]);
    double* lambda = rod.lambda.data() + 6 * k;
    const Triple<double> held = turned_back<double>({lambda[0], lambda[1], lambda[2]}, {delta[0], delta[1], delta[2]});
    lambda[0] = held.x;
    lambda[1] = held.y;
    lambda[2] = held.z;
  }
}

void displace(Rod& rod, const std::vector<Lane8>& displacements, const VectorX& delta_lambda) {
  rod.lambda += delta_lambda;
  for (std::size_t s = 0; s < rod.segments.size(); ++s) displace(rod, s, displacements[s]);
}

void displace(Rod& rod, std::size_t segment, const Lane8& displacement) {
  if (rod.segments[segment].is_static) return;
  const Lane4 shift = __builtin_shufflevector(displacement, displacement, 0, 1, 2, 6);
  const Lane4 phi = __builtin_shufflevector(displacement, displacement, 3, 4, 5, 6);
  Quaternion& q = rod.orientation[segment];
  const Lane4 by = turned(q, shift), after = turned_within(q, phi);
  rod.position[segment] += Vector3(by[0], by[1], by[2]);
  std::memcpy(q.coeffs().data(), &after, sizeof after);
}

double LinearSystem::largest_rhs() const {
  // maxCoeff() may miss a NaN; the sum does not.
  if (rhs_.size() == 0) return 0;  // a single segment has no constraints
  return std::isfinite(rhs_.sum()) ? rhs_.lpNorm<Eigen::Infinity>() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace rodsweep
