#include "solver/linear/axial_compliance.hpp"

namespace rodsweep {

Matrix3 axial_compliance(const Rod& rod, const Linearization& at, std::size_t k) {
  const Joint& joint = rod.joints[k];
  return axial_compliance(joint, at.axis[static_cast<std::size_t>(joint.a)],
                          at.axis[static_cast<std::size_t>(joint.b)]);
}

double stretch_energy(const Rod& rod, const Linearization& at, std::size_t k) {
  const Joint& joint = rod.joints[k];
  const Vector3 c = at.constraint.segment<3>(static_cast<Eigen::Index>(6 * k));
  double energy = 0;
  if (joint.axial_excess == 0) {
    for (int row = 0; row < 3; ++row)
      if (joint.compliance[row] > 0) energy += c[row] * c[row] / joint.compliance[row] / 2;
    return energy;
  }
  const double shear = joint.compliance[0], axial = shear + joint.axial_excess;
  const double along2 = c.dot(axial_compliance(rod, at, k) * c) / joint.axial_excess;  // (t.C)^2
  if (shear > 0) energy += (c.squaredNorm() - along2) / shear / 2;
  if (axial > 0) energy += along2 / axial / 2;
  return energy;
}

std::vector<std::size_t> axial_joints(const Rod& rod) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < rod.joints.size(); ++k)
    if (rod.joints[k].axial_excess != 0) out.push_back(k);
  return out;
}

void add_axial_compliance(const Rod& rod, const Linearization& at, const std::vector<std::size_t>& joints,
                          double inverse_dt2, BlockMatrix& matrix, VectorX& rhs) {
  for (const std::size_t k : joints) {
    const Matrix3 softness = inverse_dt2 * axial_compliance(rod, at, k);
    Block6& block = matrix.blocks[static_cast<std::size_t>(matrix.diagonal(static_cast<int>(k)))];
    for (int c = 0; c < 3; ++c) block.column[c] += Lane8{softness(0, c), softness(1, c), softness(2, c), 0, 0, 0, 0, 0};
    const Eigen::Index row = static_cast<Eigen::Index>(6 * k);
    rhs.segment<3>(row) -= softness * rod.lambda.segment<3>(row);
  }
}

}  // namespace rodsweep
