// Hidden layers between layers of the same width: h' = silu(W h + b), in sequence; the identity if there are none.
#pragma once

#include "network/layers/linear.hpp"

namespace rodsweep {

template <class T>
class HiddenLayers {
 public:
  /// What backward() needs of forward(); reused from batch to batch.
  struct Tape {
    std::vector<Tensor<T>> before, after;  ///< per layer: W h + b, and its silu
  };

  HiddenLayers() = default;
  HiddenLayers(Parameters<T>& parameters, const std::string& name, int width, int count, WeightSource& source);

  /// Returns the output: part of the tape, or x if there are no layers.
  const Tensor<T>& forward(const Parameters<T>& p, const Tensor<T>& x, Tape& tape) const;
  const Tensor<T>& output(const Tensor<T>& x, const Tape& tape) const {
    return layers_.empty() ? x : tape.after.back();
  }
  /// `d`: on entry the gradient with respect to the output, on return the gradient with respect to x.
  void backward(const Parameters<T>& p, const Tensor<T>& x, const Tape& tape, Tensor<T>& d,
                Parameters<T>& gradient) const;

 private:
  std::vector<Linear<T>> layers_;
};

}  // namespace rodsweep
