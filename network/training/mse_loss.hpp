// The loss of Shao et al. 2021: the mean squared error of normalised outputs, one term over joints (delta lambda) and,
// if the network predicts moves, one over segments (delta p = M^-1 J^T delta lambda).
#pragma once

#include "network/layers/tensor.hpp"

namespace rodsweep {

/// The sum of (y - target)^2 over all entries, divided by `entries`. y may be a part of a mini-batch: for the same
/// `entries` the losses and gradients of the parts add up. Sets dy if given.
template <class T>
double mse_loss(const TensorIn<T>& y, const TensorIn<T>& target, double entries, Tensor<T>* dy);

}  // namespace rodsweep
