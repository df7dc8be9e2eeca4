// Static Cosserat rods under dead loads, clamped at one end: the solution of their equations by shooting with Runge and
// Kutta's method. It shares no formula with the solver.
//
//   r' = R (e_z + S^-1 R^T n),  R' = R [u_0 + B^-1 R^T m]x,  n = P + q (L - s),  m' = -r' x n,  m(L) = 0
#pragma once

#include <cmath>
#include <stdexcept>

#include "solver/numbers/types.hpp"

namespace rodsweep {

struct StaticRod {
  double length_m = 1;
  Matrix3 clamp = Matrix3::Identity();                 ///< R(0); its z axis is the tangent
  Vector3 stretch_per_n{0, 0, 0};                      ///< diagonal of S^-1: 1 / kappa G A twice, 1 / EA
  Vector3 bend_per_nm2{1, 1, 1};                       ///< diagonal of B^-1: 1 / EI twice, 1 / GJ
  Vector3 rest_curvature_per_m{0, 0, 0};               ///< u_0, in the frame R
  Vector3 tip_force_n{0, 0, 0}, force_per_m{0, 0, 0};  ///< P and q

  /// The end at s = L, for a clamp at the origin. The loads grow from zero in 30 parts, so that Newton finds the branch
  /// that begins at rest.
  Vector3 tip() const {
    Vector3 moment(0, 0, 0);  // m(0)
    constexpr int parts = 30;
    for (int part = 1; part <= parts; ++part) moment = shot(moment, static_cast<double>(part) / parts);
    return integrated(moment, 1).r;
  }

 private:
  struct State {
    Vector3 r{0, 0, 0}, m{0, 0, 0};
    Matrix3 frame;
    State plus(double h, const State& rate) const { return {r + h * rate.r, m + h * rate.m, frame + h * rate.frame}; }
  };

  State rate(double s, const State& at, double load) const {
    const Vector3 n = load * (tip_force_n + (length_m - s) * force_per_m);
    const Vector3 along = at.frame * (Vector3::UnitZ() + stretch_per_n.cwiseProduct(Vector3(at.frame.transpose() * n)));
    const Vector3 u = rest_curvature_per_m + bend_per_nm2.cwiseProduct(Vector3(at.frame.transpose() * at.m));
    Matrix3 cross;
    cross << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
    return {along, -along.cross(n), at.frame * cross};
  }

  State integrated(const Vector3& moment, double load) const {
    constexpr int steps = 200;
    const double h = length_m / steps;
    State at{Vector3::Zero(), moment, clamp};
    for (int i = 0; i < steps; ++i) {
      const double s = i * h;
      const State k1 = rate(s, at, load), k2 = rate(s + h / 2, at.plus(h / 2, k1), load),
                  k3 = rate(s + h / 2, at.plus(h / 2, k2), load), k4 = rate(s + h, at.plus(h, k3), load);
      at = at.plus(h / 6, k1).plus(h / 3, k2).plus(h / 3, k3).plus(h / 6, k4);
    }
    return at;
  }

  /// The moment at the clamp that leaves none at the end, by Newton's method from a guess.
  Vector3 shot(Vector3 moment, double load) const {
    const double scale = 1 / (bend_per_nm2.maxCoeff() * length_m), nudge = 1e-6 * scale;
    for (int iteration = 0; iteration < 50; ++iteration) {
      const Vector3 missed = integrated(moment, load).m;
      if (missed.norm() < 1e-10 * scale) return moment;
      Matrix3 slope;
      for (int c = 0; c < 3; ++c)
        slope.col(c) = (integrated(moment + nudge * Vector3::Unit(c), load).m - missed) / nudge;
      moment -= slope.inverse() * missed;
    }
    throw std::runtime_error("the shooting did not converge");
  }
};

}  // namespace rodsweep
