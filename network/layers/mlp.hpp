// Two layers with SiLU between them, y = W2 silu(W1 x + b1) + b2, silu(a) = a / (1 + exp(-a)). Further hidden layers of
// the same width (hidden_layers.hpp) follow the first.
#pragma once

#include "network/layers/hidden_layers.hpp"

namespace rodsweep {

template <class T>
class Mlp {
 public:
  /// What backward() needs of forward(); reused from batch to batch.
  struct Tape {
    Tensor<T> before, hidden;  ///< W1 x + b1, and its silu
    typename HiddenLayers<T>::Tape deeper;
  };

  Mlp() = default;
  Mlp(Parameters<T>& parameters, const std::string& name, int in, int hidden, int out, WeightSource& source,
      double last_gain = 1, int hidden_layers = 1);

  int in() const { return first_.in(); }

  void forward(const Parameters<T>& p, const TensorIn<T>& x, Tape& tape, Tensor<T>& y) const;
  void backward(const Parameters<T>& p, const TensorIn<T>& x, const Tape& tape, const TensorIn<T>& dy,
                Parameters<T>& gradient, Tensor<T>* dx) const;

 private:
  Linear<T> first_, second_;
  HiddenLayers<T> deeper_;
};

}  // namespace rodsweep
