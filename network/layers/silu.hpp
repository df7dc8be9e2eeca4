// The activation silu(a) = a logistic(a) and its derivative, as array expressions.
#pragma once

#include <Eigen/Core>

namespace rodsweep {

template <class Derived>
auto silu(const Eigen::ArrayBase<Derived>& a) {
  return a.derived() * a.derived().logistic();
}

/// s + a s (1 - s), s the logistic function.
template <class Derived>
auto silu_derivative(const Eigen::ArrayBase<Derived>& a) {
  using T = typename Derived::Scalar;
  return a.derived().logistic() * (T(1) + a.derived() * (T(1) - a.derived().logistic()));
}

}  // namespace rodsweep
