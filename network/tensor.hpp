// Dense arrays of the network: one column per item (segment, joint or graph), one row per feature.
//
// Everything is a template over the scalar: float in use, double where gradients are checked by finite differences.
#pragma once

#include <Eigen/Core>

namespace rodsweep {

template <class T>
using Tensor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;  ///< [features, items], column-major

template <class T>
using TensorIn = Eigen::Ref<const Tensor<T>>;

}  // namespace rodsweep
