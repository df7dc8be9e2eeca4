// Cross-sections: their geometry, stiffness, and the compliance of joints.
//
// Axes are the segments' local x and y. A rectangle or an ellipse has its width along x and its height along y.
#pragma once

#include "solver/numbers/types.hpp"

namespace rodsweep {

struct CrossSection {
  double area_m2;
  double second_moment_x_m4;  ///< integral of y^2: bending about x
  double second_moment_y_m4;  ///< integral of x^2
  double torsion_constant_m4;
  double shear_coefficient;  ///< kappa
};

/// The stiffness of a cross-section.
struct Section {
  double bending_x_nm2, bending_y_nm2;  ///< EI about the local x and y axis
  double torsion_nm2;                   ///< GJ
  double axial_n, shear_n;              ///< EA, kappa G A
};

// Shapes for Poisson's number nu. Shear coefficients as of Timoshenko 1922; Kaneko 1975; Hutchinson 2001 (tubes).
CrossSection circle(double radius_m, double nu);
CrossSection tube(double radius_m, double wall_m, double nu);        ///< outer radius
CrossSection ellipse(double width_m, double height_m, double nu);    ///< shear coefficient of a circle
CrossSection rectangle(double width_m, double height_m, double nu);  ///< Saint-Venant's series for J

/// nu = E / 2G - 1, limited to 0 .. 1/2, because E and G are independent parameters.
double poisson_number(double youngs_modulus_pa, double torsion_modulus_pa);

Section stiffness(const CrossSection& of, double youngs_modulus_pa, double torsion_modulus_pa);
Section circular_section(double radius_m, double youngs_modulus_pa, double torsion_modulus_pa);

/// Compliance of a joint: `stretch` for the three stretch-shear rows, or physical stretch, 1 / (kappa G A l) across the
/// rod and 1 / (E A l) along it; and bend-twist compliance (l/EI, l/EI, l/GJ).
Vector6 joint_compliance(double length_m, const Section& section, double stretch_per_j);
Vector6 physical_compliance(double length_m, const Section& section);

/// The default "inextensible" compliance: a joint under the force F stretches by 1e-7 of its length l: 1e-7 / (l F).
double inextensible_compliance(double joint_length_m, double force_n);

}  // namespace rodsweep
