// y = W x + b for every column of x: one matrix product. Backward adds to the gradients of W and b.
#pragma once

#include "network/layers/parameters.hpp"

namespace rodsweep {

template <class T>
class Linear {
 public:
  Linear() = default;
  Linear(Parameters<T>& parameters, const std::string& name, int in, int out, WeightSource& source, double gain = 1);

  int in() const { return in_; }
  int out() const { return out_; }
  int weight() const { return weight_; }  ///< index among the parameters
  int bias() const { return bias_; }

  /// y must be of the right size and not overlap x.
  void forward(const Parameters<T>& p, const TensorIn<T>& x, Eigen::Ref<Tensor<T>> y) const;
  /// Adds W^T dy to dx, if given.
  void backward(const Parameters<T>& p, const TensorIn<T>& x, const TensorIn<T>& dy, Parameters<T>& gradient,
                Tensor<T>* dx) const;

 private:
  int weight_ = -1, bias_ = -1, in_ = 0, out_ = 0;
};

}  // namespace rodsweep
