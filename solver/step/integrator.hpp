// The schemes in time: implicit Euler, as in Deul et al. 2018 and Shao et al. 2021, and BDF2 (Curtiss and Hirschfelder
// 1952). Both are one formula, with the forces at the end of the step:
//
//   x = x^ + h v,   q = rotated(q^, h w),   v (1 + c h) = v^ + h (g + f / m),   L (1 + c h) = L^ + h tau
//
//   euler   first order,   h = dt,       x^ = x_n,                     v^ = v_n, ...
//   bdf2    second order,  h = 2 dt / 3, x^ = (4 x_n - x_(n-1)) / 3,   v^ = (4 v_n - v_(n-1)) / 3, ...
//
// L is the angular momentum in the world. So constraints, compliance, damping and contacts only see another time step,
// h. The first step of BDF2 is one of Euler.
#pragma once

namespace rodsweep {

enum class Integrator { euler, bdf2 };

/// h of a step of dt.
constexpr double implicit_dt(double dt, bool uses_two_steps) { return uses_two_steps ? 2 * dt / 3 : dt; }

}  // namespace rodsweep
