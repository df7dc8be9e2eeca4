// The letters used in formulas throughout the solver, and the fixed-size types behind them. All quantities are SI.
//
//   x_i  segment centre [m]              q_i  orientation, unit quaternion, local z along the rod
//   v_i  linear velocity [m/s]           w_i  angular velocity, world frame [rad/s]
//   l    joint length, the mean of its two segments' lengths [m]
//   C    constraint values (6 per joint, dimensionless): stretch-shear (3), then bend-twist (3)
//   u, phi  motion of a segment in its own frame: dx = R u, and a rotation vector; dtheta = R phi in the world
//   J    Jacobian of C with respect to (u, phi) of the two segments
//   M    mass matrix, diagonal: m_i (3), principal moments of inertia (3)
//   alpha   compliance [1/J], alpha~ = alpha / dt^2 [1/(kg m^2)]
//   lambda  Lagrange multipliers [kg m^2]: J^T lambda / dt^2 are the generalised forces
//   A = J M^-1 J^T + alpha~,  b = -C - alpha~ lambda
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

namespace rodsweep {

using Vector3 = Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix3 = Eigen::Matrix3d;
using VectorX = Eigen::VectorXd;
using Quaternion = Eigen::Quaterniond;

inline constexpr double pi = 3.14159265358979323846;

/// An index of a standard container; segments, joints and steps have numbers of type int.
constexpr std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The larger of two numbers, or NaN if either is NaN: std::max ignores a NaN in second place.
inline double larger_or_nan(double a, double b) { return a > b || std::isnan(a) ? a : b; }

}  // namespace rodsweep
