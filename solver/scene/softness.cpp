#include "solver/scene/softness.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace rodsweep {

Softness cone(double radius_m, double end_radius_m, double length_m, const std::function<Section(double)>& section) {
  const auto integral = [&](double Section::*stiffness) {
    if (radius_m == end_radius_m) return length_m / section(radius_m).*stiffness;
    return length_m *
           boost::math::quadrature::gauss<double, 20>::integrate(
               [&](double t) { return 1 / section(radius_m + t * (end_radius_m - radius_m)).*stiffness; }, 0.0, 1.0);
  };
  return {length_m, integral(&Section::bending_x_nm2), integral(&Section::torsion_nm2), integral(&Section::shear_n),
          integral(&Section::axial_n)};
}

double mean_radius(double radius_m, double end_radius_m) {
  const double a = radius_m, b = end_radius_m;
  return a == b ? a : std::sqrt((a * a + a * b + b * b) / 3);
}

Softness operator+(const Softness& a, const Softness& b) {
  return {a.length_m + b.length_m, a.bend + b.bend, a.twist + b.twist, a.shear + b.shear, a.axial + b.axial};
}

Series in_series(const Softness& a, const Softness& b, const Quaternion& rest) {
  const Vector3 axis = Vector3::UnitZ(), next = rest * axis, across = axis.cross(next);
  const double kink = std::atan2(across.norm(), axis.dot(next));
  // Principal axes in the kink's plane: c_a t_a t_a^T + c_b t_b t_b^T, as vectors of twice their angle from t_a.
  const double of_a = a.twist - a.bend, of_b = b.twist - b.bend;
  const double middle = kink * b.length_m / (a.length_m + b.length_m);
  const double y = of_b * std::sin(2 * kink), x = of_a + of_b * std::cos(2 * kink);
  const bool even = std::hypot(x, y) <= 1e-12 * (a.bend + b.bend);
  const double twice = even ? 0 : std::remainder(std::atan2(y, x) - 2 * middle, pi);
  const double turn = middle + twice / 2;

  constexpr double straight = 1e-9;
  const Vector3 n = across.norm() > straight ? Vector3(across.normalized()) : Vector3::UnitX();
  const auto tensor = [&](double Softness::*normal, double Softness::*along) -> Vector3 {
    const double base = a.*normal + b.*normal, extra_a = a.*along - a.*normal, extra_b = b.*along - b.*normal;
    const auto square = [](double value) { return value * value; };
    return {base, base + extra_a * square(std::sin(turn)) + extra_b * square(std::sin(kink - turn)),
            base + extra_a * square(std::cos(turn)) + extra_b * square(std::cos(kink - turn))};
  };
  Series out{tensor(&Softness::shear, &Softness::axial), tensor(&Softness::bend, &Softness::twist), {}};
  Matrix3 axes;
  axes.col(0) = n;
  axes.col(2) = Eigen::AngleAxisd(turn, n) * axis;
  axes.col(1) = axes.col(2).cross(n);
  out.frame = kink > straight ? Quaternion(axes) : Quaternion::Identity();
  return out;
}

}  // namespace rodsweep
