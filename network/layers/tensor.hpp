// Dense arrays of the network: one column per item (segment, joint or graph), one row per feature.
//
// Everything is a template over the scalar: float in use, double where gradients are checked by finite differences.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rodsweep {

template <class T>
using Tensor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;  ///< [features, items], column-major

template <class T>
using TensorIn = Eigen::Ref<const Tensor<T>>;

/// Aligned for vector registers, equally in every process, so that sums have the same bits.
template <class T>
using AlignedVector = std::vector<T, Eigen::aligned_allocator<T>>;

}  // namespace rodsweep
