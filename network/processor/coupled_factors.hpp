// Learned factors over all couplings of a matrix (coupled_passes.hpp), predicted for all joints at once.
//
//   m_kj = ramp(U vec(B_kj) + u)                                  a message to the row, and one to the column
//   e_k = ramp(W [a_k; t_k; sums of messages to k] + b)           by sides of k, from earlier and from later places
//   f_k = ramp(W' [e_k; sums over later places i of e_i] + b')    by sides of k; g_k of f in the same way
//   (C_k, T_k0, T_k1) = W* g_k + b*,   N_k = C_k C_k^T
// a_k are the entries of A's diagonal block minus 1 on the diagonal, t_k those of coupling_features(). All blocks are
// those of a scaled system in canonical frames (network/encoding/canonical_frames.hpp). N is positive definite, and so
// is the operator. Initially C = I and T = 0 up to small random weights, which is Jacobi's preconditioner.
#pragma once

#include "network/layers/linear.hpp"
#include "network/processor/coupled_passes.hpp"

namespace rodsweep {

/// t_k of all places, [6, places]: exp(-height_k / 1, 4, 16, 64), with height_k the length of the longest path of
/// couplings from k through later places; a quarter of the number of k's earlier neighbours, and of later ones.
Tensor<float> coupling_features(const std::vector<SystemPattern::Coupling>& couplings, Eigen::Index places);

template <class T>
class CoupledFactors {
 public:
  static constexpr int triangle = 21, coupling_features = 6, own_features = triangle + coupling_features;

  struct Tape {
    Tensor<T> before_m, m, x, before_e, e, before_f, f, before_g, g, outputs, factors;
    CoupledPasses<T> passes;
  };

  CoupledFactors() = default;
  CoupledFactors(Parameters<T>& parameters, int latent, WeightSource& source);

  /// Sets tape.factors [93, places] of the systems' matrices.
  void predict(const Parameters<T>& p, const ScaledSystem<T>& systems, Tape& tape) const;
  /// Adds to `gradient` from the derivatives with respect to tape.factors.
  void learn(const Parameters<T>& p, const ScaledSystem<T>& systems, const Tape& tape, const TensorIn<T>& d_factors,
             Parameters<T>& gradient) const;

  /// The output [6, places] for the systems' residuals.
  void forward(const Parameters<T>& p, const ScaledSystem<T>& systems, Tape& tape, Tensor<T>& y) const;
  /// Adds to `gradient`; `systems` is data: its derivatives are not computed.
  void backward(const Parameters<T>& p, const ScaledSystem<T>& systems, const Tape& tape, const TensorIn<T>& dy,
                Parameters<T>& gradient) const;

  int latent() const { return latent_; }
  /// The layers, for network/processor/coupled_inference.cpp.
  struct Layers {
    const Linear<T>&message, &encode, &join, &join_again, &factors;
  };
  Layers layers() const { return {message_, encode_, join_, join_again_, factors_}; }

 private:
  int latent_ = 0;
  Linear<T> message_, encode_, join_, join_again_, factors_;
};

}  // namespace rodsweep
