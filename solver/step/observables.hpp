// Measures of a scene: length, gaps, energies, momenta. Pure functions of the state; SI.
#pragma once

#include "solver/rod/linearization.hpp"
#include "solver/scene/scene.hpp"

namespace rodsweep {

/// Length of a rod through its joint midpoints: a joint's midpoint is its shared point as seen from both sides,
/// averaged. From midpoint to midpoint within each segment, plus from the outermost midpoints to the free ends. A
/// polyline of segment centres would show bending as drift. A joint within a segment, as where the rods of a net cross,
/// does not end it: the length of a net is that of all its rods together, that of a ring its circumference.
double rod_length(const Rod& rod);

/// max over joints of |x_a + rho_a - x_b - rho_b| / l.
double joint_gap(const Rod& rod);

/// max |C + alpha~ lambda|, alpha~ = alpha / constraint_dt^2 (Rod::constraint_dt): the residual of Newton.
double newton_residual(const Rod& rod, double constraint_dt);
double newton_residual(const Rod& rod, const Linearization& at, double constraint_dt);  ///< with a known linearisation

/// The largest imbalance of forces on a segment, relative to the largest force of a joint (MomentumBalance::residual).
double momentum_residual(const Rod& rod);

/// Sum over joints of C^T alpha^-1 C / 2 [J] of bending, twist and, but for inextensible joints, stretch and shear; rows
/// of zero compliance store no energy.
double elastic_energy(const Rod& rod);
double elastic_energy(const Rod& rod, const Linearization& at);

/// The same of the stretch-shear rows of inextensible joints: no energy of the rod, but what its open joints can release.
double gap_energy(const Rod& rod);
double gap_energy(const Rod& rod, const Linearization& at);

/// m |v|^2 / 2 + w.I w / 2 over the dynamic segments [J].
double kinetic_energy(const Rod& rod);

/// -m g.x over the dynamic segments [J].
double gravitational_energy(const Rod& rod, const Vector3& gravity_m_s2);

Vector3 linear_momentum(const Rod& rod);   ///< of the dynamic segments [kg m/s]
Vector3 angular_momentum(const Rod& rod);  ///< of the dynamic segments, about the origin [kg m^2/s]

bool is_finite(const Rod& rod);

}  // namespace rodsweep
