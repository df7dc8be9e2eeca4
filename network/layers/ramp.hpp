// The activation ramp(a), zero below -1, a above 1 and a parabola between, and its derivative, as array expressions:
//   t = clamp(a, -1, 1),   ramp = (t + 1)^2 / 4 + max(a - 1, 0),   ramp' = (t + 1) / 2
// It trains as well as silu.hpp, without an exponential and a division.
#pragma once

#include <Eigen/Core>

namespace rodsweep {

template <class Derived>
auto ramp_derivative(const Eigen::ArrayBase<Derived>& a) {
  using T = typename Derived::Scalar;
  return (a.derived().max(T(-1)).min(T(1)) + T(1)) / T(2);
}

template <class Derived>
auto ramp(const Eigen::ArrayBase<Derived>& a) {
  using T = typename Derived::Scalar;
  return ramp_derivative(a).square() + (a.derived() - T(1)).max(T(0));
}

}  // namespace rodsweep
