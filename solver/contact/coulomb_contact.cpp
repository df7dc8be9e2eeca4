#include "solver/contact/coulomb_contact.hpp"

namespace rodsweep {

CoulombContact::CoulombContact(const Matrix3& mobility, double friction)
    : friction_(friction), normal_weight_(mobility(0, 0)), by_normal_{mobility(1, 0), mobility(2, 0)} {
  const double yy = mobility(1, 1), yz = mobility(1, 2), zz = mobility(2, 2), determinant = yy * zz - yz * yz;
  stick_[0] = zz / determinant;
  stick_[1] = -yz / determinant;
  stick_[2] = yy / determinant;
  sliding_weight_ = (yy + zz) / 2 + std::hypot((yy - zz) / 2, yz);
  stop_ = 1 / normal_weight_;
  slide_ = 1 / sliding_weight_;
}

}  // namespace rodsweep
