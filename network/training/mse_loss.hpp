// The loss of Shao et al. 2021: the mean squared error of normalised outputs, over joints (delta lambda) and, where the
// network has them, segments (delta p = M^-1 J^T delta lambda); one term each.
#pragma once

#include "network/layers/tensor.hpp"

namespace rodsweep {

/// The sum of (y - target)^2 over all entries, over `entries`: those of the whole mini-batch, of which y may be a part,
/// so that the parts' losses and gradients add up. Sets dy if it is given.
template <class T>
double mse_loss(const TensorIn<T>& y, const TensorIn<T>& target, double entries, Tensor<T>* dy);

}  // namespace rodsweep
