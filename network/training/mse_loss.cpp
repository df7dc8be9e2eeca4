#include "network/training/mse_loss.hpp"

namespace rodsweep {

template <class T>
double mse_loss(const TensorIn<T>& y, const TensorIn<T>& target, double entries, Tensor<T>* dy) {
  if (dy) *dy = static_cast<T>(2 / entries) * (y - target);
  return (y - target).template cast<double>().squaredNorm() / entries;
}

template double mse_loss<float>(const TensorIn<float>&, const TensorIn<float>&, double, Tensor<float>*);
template double mse_loss<double>(const TensorIn<double>&, const TensorIn<double>&, double, Tensor<double>*);

}  // namespace rodsweep
