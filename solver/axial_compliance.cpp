#include "solver/axial_compliance.hpp"

namespace rodsweep {
namespace {

Vector3 direction(const Linearization& at, const Joint& joint) {
  return (at.axis[static_cast<std::size_t>(joint.a)] + at.axis[static_cast<std::size_t>(joint.b)]).normalized();
}

}  // namespace

Vector3 axial_part(const Rod& rod, const Linearization& at, std::size_t k, const Vector3& lambda) {
  const Joint& joint = rod.joints[k];
  if (joint.axial_excess == 0) return Vector3::Zero();
  const Vector3 t = direction(at, joint);
  return joint.axial_excess * t.dot(lambda) * t;
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
  const double along = direction(at, joint).dot(c);
  const double shear = joint.compliance[0], axial = shear + joint.axial_excess;
  if (shear > 0) energy += (c.squaredNorm() - along * along) / shear / 2;
  if (axial > 0) energy += along * along / axial / 2;
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
    const Vector3 t = direction(at, rod.joints[k]);
    const double excess = inverse_dt2 * rod.joints[k].axial_excess;
    Block6& block = matrix.blocks[static_cast<std::size_t>(matrix.diagonal(static_cast<int>(k)))];
    for (int c = 0; c < 3; ++c) block.column[c] += excess * t[c] * Lane8{t[0], t[1], t[2], 0, 0, 0, 0, 0};
    const Eigen::Index row = static_cast<Eigen::Index>(6 * k);
    rhs.segment<3>(row) -= inverse_dt2 * axial_part(rod, at, k, rod.lambda.segment<3>(row));
  }
}

}  // namespace rodsweep
