// A learned block factorisation: an operator that is linear and symmetric, as A^-1 is.
//
// Block elimination of a tree's joints from the tips to the root (solver/factor/block_factor.hpp) needs the inverses of
// the Schur complements S_k = A_kk - sum over children c of B_c^T S_c^-1 B_c. B_c is A's block of a child's row
// and its parent's column. It then solves A y = r by two passes. Here a network replaces S_k^-1 by symmetric matrices,
// N_k on the diagonal and T_k beside B_k. It predicts them for all joints at once from three generations of the tree:
//   e_k = ramp(W a_k + V t_k + b),   t_k = exp(-height_k / 1, 4, 16, 64), beside_k / 4
//   f_k = ramp(W' [e_k; sum_c e_c] + b'),   g_k = ramp(W'' [f_k; sum_c f_c] + b'')
//   (N_k, T_k) = W* g_k + b*,  lower triangles by columns
//   h_k = r_k - sum_c B_c^T T_c h_c                    tips to roots
//   y_k = N_k h_k - T_k B_k y_parent                   roots to tips
// a_k are the features of A's blocks and r_k those of the residual (network/encoding/system_encoding.hpp). height_k is
// the number of joints between k and the farthest tip, beside_k the number of couplings of k except parent and
// children. The blocks of those couplings are omitted. With N = T = S^-1 a chain is solved exactly. Initially N = I and
// T = 0 up to small random weights, which is Jacobi's preconditioner.
//
// A product of many T_k may grow without bound during training: a state longer than `longest_state` is dropped.
#pragma once

#include "network/encoding/system_encoding.hpp"
#include "network/graph/joint_forest.hpp"
#include "network/layers/linear.hpp"

namespace rodsweep {

/// t_k of all places, [5, places].
Tensor<float> place_features(const JointForest& forest);

template <class T>
class FactorSweeps {
 public:
  static constexpr int triangle = 21, place_features = 5;
  static constexpr int residual_features = 6, block_features = SystemEncoding::size - residual_features;
  static constexpr int coupling = SystemEncoding::coupling;  ///< the first feature of B_k
  static constexpr T longest_state = 1e4;

  struct Tape {
    Tensor<T> a, before_e, e, before_f, f, before_g, g, factors, h, v, y;
  };

  FactorSweeps() = default;
  FactorSweeps(Parameters<T>& parameters, int latent, WeightSource& source);

  /// x [57, places] -> y [6, places], in the order of the forest.
  void forward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, Tape& tape, Tensor<T>& y) const;
  /// Adds to `gradient`; x is data: its derivatives are not computed.
  void backward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, const Tape& tape,
                const TensorIn<T>& dy, Parameters<T>& gradient) const;

  int latent() const { return latent_; }
  /// The layers, for network/processor/factor_inference.cpp.
  struct Layers {
    const Linear<T>&encode, &join, &join_again, &factors;
  };
  Layers layers() const { return {encode_, join_, join_again_, factors_}; }

 private:
  int latent_ = 0;
  Linear<T> encode_, join_, join_again_, factors_;
};

}  // namespace rodsweep
