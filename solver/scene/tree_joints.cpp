#include "solver/scene/tree_joints.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace rodsweep {
namespace {

/// Moduli that grow with the radius, from those of the widest edge at the ground.
class Wood {
 public:
  Wood(const Skeleton& skeleton, const RodParameters& p, double modulus_exponent)
      : parameters_(p), exponent_(modulus_exponent) {
    for (const SkeletonNode& node : skeleton)
      if (node.parent == 0) trunk_radius_m_ = std::max(trunk_radius_m_, node.base_radius_m);
  }
  Section section(double radius_m) const {
    const double factor = exponent_ == 0 ? 1 : std::pow(radius_m / trunk_radius_m_, exponent_);
    return circular_section(radius_m, factor * parameters_.youngs_modulus_pa, factor * parameters_.torsion_modulus_pa);
  }

 private:
  const RodParameters& parameters_;
  double exponent_, trunk_radius_m_ = 0;
};

/// Compliance of a part of an edge, about and along axes across it (bend, shear) and its own axis (twist, axial).
struct Softness {
  double length_m = 0;
  double bend = 0, twist = 0;   ///< [1/Nm]
  double shear = 0, axial = 0;  ///< [m/N]
};

/// Of a cone, from the radii at its ends.
Softness cone(double radius_m, double end_radius_m, double length_m, const Wood& wood) {
  const auto integral = [&](double Section::*stiffness) {
    if (radius_m == end_radius_m) return length_m / wood.section(radius_m).*stiffness;
    return length_m *
           boost::math::quadrature::gauss<double, 20>::integrate(
               [&](double t) { return 1 / wood.section(radius_m + t * (end_radius_m - radius_m)).*stiffness; }, 0.0,
               1.0);
  };
  return {length_m, integral(&Section::bending_x_nm2), integral(&Section::torsion_nm2), integral(&Section::shear_n),
          integral(&Section::axial_n)};
}

Softness operator+(const Softness& a, const Softness& b) {
  return {a.length_m + b.length_m, a.bend + b.bend, a.twist + b.twist, a.shear + b.shear, a.axial + b.axial};
}

/// Compliance of two parts in series and its frame, seen from part a, whose axis is z; `rest` turns that to b's.
struct Series {
  Vector3 stretch, bend;
  Quaternion frame;
};

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

}  // namespace

std::vector<JointSpec> tree_joints(const Skeleton& skeleton, const std::vector<SegmentSpec>& segments,
                                   const RodParameters& p, double modulus_exponent) {
  const Wood wood(skeleton, p, modulus_exponent);
  std::vector<int> branches(skeleton.size());
  for (std::size_t i = 1; i < skeleton.size(); ++i) ++branches[at(skeleton[i].parent)];
  std::vector<double> carried(segments.size());  // [N], by the joint below each segment
  for (std::size_t i = segments.size() - 1; i > 0; --i) {
    carried[i] += weight({segments[i]}, p);
    carried[at(skeleton[i].parent)] += carried[i];
  }
  const auto half = [&](std::size_t i, bool upper) {
    const SkeletonNode& node = skeleton[i];
    const double middle = (node.base_radius_m + node.radius_m) / 2;
    return cone(middle, upper ? node.radius_m : node.base_radius_m, segments[i].length_m / 2, wood);
  };
  std::vector<JointSpec> joints;
  joints.reserve(segments.size() - 1);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const std::size_t below = at(skeleton[i].parent);
    const SegmentSpec &a = segments[below], &b = segments[i];
    const Softness of_a = below > 0 && branches[below] == 1 ? half(below, true) : Softness();
    const Softness of_b = branches[i] > 1 ? half(i, false) + half(i, true) : half(i, false);
    const Quaternion rest = (a.orientation.conjugate() * b.orientation).normalized();
    const Series series = in_series(of_a, of_b, rest);

    JointSpec& joint = joints.emplace_back();
    joint.a = static_cast<int>(below);
    joint.b = static_cast<int>(i);
    joint.arm_a_m = Vector3(0, 0, a.length_m / 2);
    joint.arm_b_m = Vector3(0, 0, -b.length_m / 2);
    joint.rest = rest;
    joint.frame = series.frame;
    const double length = (a.length_m + b.length_m) / 2;
    if (p.stretch == Stretch::physical)
      joint.compliance_per_j.head<3>() = series.stretch / (length * length);
    else
      joint.compliance_per_j.head<3>().setConstant(
          p.stretch_compliance_per_j.value_or(inextensible_compliance(length, carried[i])));
    joint.compliance_per_j.tail<3>() = series.bend;
  }
  return joints;
}

}  // namespace rodsweep
