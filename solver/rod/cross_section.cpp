#include "solver/rod/cross_section.hpp"

#include <algorithm>
#include <cmath>

namespace rodsweep {

CrossSection circle(double radius_m, double nu) { return tube(radius_m, radius_m, nu); }

CrossSection tube(double radius_m, double wall_m, double nu) {
  const double inner = radius_m - wall_m, a2 = radius_m * radius_m, b2 = inner * inner;
  const double area = pi * wall_m * (radius_m + inner), moment = area * (a2 + b2) / 4;
  const double squares = a2 + b2, fourths = a2 * a2 + b2 * b2, both = a2 * b2;
  const double shear =
      6 * squares * squares * (1 + nu) * (1 + nu) /
      (7 * fourths + 34 * both + nu * (12 * fourths + 48 * both) + nu * nu * (4 * fourths + 16 * both));
  return {area, moment, moment, 2 * moment, shear};
}

CrossSection ellipse(double width_m, double height_m, double nu) {
  const double a = width_m / 2, b = height_m / 2, a2 = a * a, b2 = b * b, area = pi * a * b;
  return {area, area * b2 / 4, area * a2 / 4, area * a2 * b2 / (a2 + b2), circle(1, nu).shear_coefficient};
}

CrossSection rectangle(double width_m, double height_m, double nu) {
  const double area = width_m * height_m, longer = std::max(width_m, height_m), shorter = std::min(width_m, height_m);
  double series = 0;
  for (int n = 1; n < 20; n += 2)  // later ones are below rounding
    series += (std::tanh(n * pi * longer / (2 * shorter)) - 1) / std::pow(n, 5);
  constexpr double odd_fifths = 1.0045237627951396;  // sum of 1 / n^5, n odd: 31/32 zeta(5)
  const double torsion = longer * shorter * shorter * shorter *
                         (1.0 / 3 - 64 / std::pow(pi, 5) * shorter / longer * (odd_fifths + series));
  return {area, area * height_m * height_m / 12, area * width_m * width_m / 12, torsion, (5 + 5 * nu) / (6 + 5 * nu)};
}

double poisson_number(double youngs_modulus_pa, double torsion_modulus_pa) {
  return std::clamp(youngs_modulus_pa / (2 * torsion_modulus_pa) - 1, 0.0, 0.5);
}

Section stiffness(const CrossSection& of, double youngs_modulus_pa, double torsion_modulus_pa) {
  return {youngs_modulus_pa * of.second_moment_x_m4, youngs_modulus_pa * of.second_moment_y_m4,
          torsion_modulus_pa * of.torsion_constant_m4, youngs_modulus_pa * of.area_m2,
          of.shear_coefficient * torsion_modulus_pa * of.area_m2};
}

Section circular_section(double radius_m, double youngs_modulus_pa, double torsion_modulus_pa) {
  return stiffness(circle(radius_m, poisson_number(youngs_modulus_pa, torsion_modulus_pa)), youngs_modulus_pa,
                   torsion_modulus_pa);
}

Vector6 joint_compliance(double length_m, const Section& section, double stretch_per_j) {
  Vector6 alpha;
  alpha << stretch_per_j, stretch_per_j, stretch_per_j, length_m / section.bending_x_nm2,
      length_m / section.bending_y_nm2, length_m / section.torsion_nm2;
  return alpha;
}

Vector6 physical_compliance(double length_m, const Section& section) {
  Vector6 alpha = joint_compliance(length_m, section, 1 / (section.shear_n * length_m));
  alpha[2] = 1 / (section.axial_n * length_m);
  return alpha;
}

double inextensible_compliance(double joint_length_m, double force_n) { return 1e-7 / (joint_length_m * force_n); }

}  // namespace rodsweep
