// A gated recurrent unit (Cho et al. 2014) with the reset gate after the product, as in cuDNN:
//   z = logistic(P_z + U_z h),  r = logistic(P_r + U_r h),  c = tanh(P_c + r * (U_c h)),  h' = (1 - z) * c + z * h
// P = W x + b (3 H rows: z, r, c) is the caller's: one product for all items at once; only U h waits for the
// recurrence.
#pragma once

#include "network/layers/parameters.hpp"

namespace rodsweep {

template <class T>
class Gru {
 public:
  struct Tape {
    Tensor<T> z, r, c, uc, h;  ///< [H, items]: gates, candidate, U_c h, and the h that went in
  };

  Gru() = default;
  Gru(Parameters<T>& parameters, const std::string& name, int size, WeightSource& source);
  int size() const { return size_; }
  int recurrent() const { return recurrent_; }  ///< index of U among the parameters

  /// Columns [first, first + h.cols()) of the tape and of `out`; `p_in` the same columns of P.
  void forward(const Parameters<T>& p, const TensorIn<T>& p_in, const TensorIn<T>& h, Tape& tape, Eigen::Index first,
               Eigen::Ref<Tensor<T>> out) const;
  /// From d_out: dP (set) and dh (set) of the same columns; adds to the gradient of U.
  void backward(const Parameters<T>& p, const Tape& tape, Eigen::Index first, const TensorIn<T>& d_out,
                Parameters<T>& gradient, Eigen::Ref<Tensor<T>> dp, Eigen::Ref<Tensor<T>> dh) const;

 private:
  int recurrent_ = -1, size_ = 0;
};

}  // namespace rodsweep
