// The learned factors of network/processor/factor_sweeps.hpp for one rod at a time: no allocation, no tape.
//
// Factors are predicted for all joints at once, in canonical frames, and transformed to the joints' frames, where M_k
// is formed. With P_k = T_k S_k, the transformation to a canonical frame and the scale in it
// (network/encoding/canonical_frames.hpp),
//   N_k <- P_k^T N_k P_k,   M_k <- P_k^T T_k P_k B_k
// so that a solve uses residuals without scaling, in two sequential passes with one matrix product per joint. Layers
// have operands of 16 bits (network/layers/narrow_product.hpp), passes single precision. The results differ from the
// training code's in rounding, and where that code drops a state (FactorSweeps::longest_state).
#pragma once

#include "network/encoding/canonical_frames.hpp"
#include "network/layers/narrow_product.hpp"
#include "network/processor/factor_sweeps.hpp"

namespace rodsweep {

class FactorInference {
 public:
  /// Whether there are kernels for a latent size: multiples of 16.
  static bool supports(int latent) { return latent > 0 && latent % 16 == 0; }

  /// Throws std::invalid_argument for a latent size without kernels. `forest` and `pattern` must outlive this.
  FactorInference(const FactorSweeps<float>& sweeps, const Parameters<float>& weights, const JointForest& forest,
                  const SystemPattern& pattern);

  /// Sets the factors of a matrix from its features [57, places] (without the residual) and its frames. With `positive`
  /// negative eigenvalues of the N_k change their sign: then the factors are positive definite, since they are
  /// L^T N L with a triangular L.
  void factorise(const TensorIn<float>& x, const CanonicalFrames& frames, const BlockMatrix& a, bool positive = false);

  /// Sets d to the factors' solution for a residual r of the matrix.
  void solve(const VectorX& r, VectorX& d);

 private:
  using Lane16 = float __attribute__((vector_size(64)));
  struct alignas(64) Joint {
    Lane16 n[3], m[3], m_transposed[3];  ///< columns 2 q and 2 q + 1, in lanes 0..5 and 8..13
  };
  void form(int place, const CanonicalFrames& frames, const BlockMatrix& a);

  const JointForest& forest_;
  const SystemPattern& pattern_;
  NarrowMatrix encode_, join_, join_again_, last_;
  Tensor<float> start_;  ///< [H, places] V t + b
  Eigen::VectorXf join_bias_, join_again_bias_, last_bias_;
  NarrowColumns a_, e_, f_, g_;  ///< [52, places]; [2 H, places] x_k and its children's sum; [H, places]
  Tensor<float> before_, sums_;  ///< [H, places]
  Tensor<float> factors_;  ///< [48, places]: triangles, N's 16 first entries, 5 last of N, 5 last of T, T's 16 first
  std::vector<Joint> joints_;
  std::vector<Lane16> h_, d_;  ///< states, in both halves
};

}  // namespace rodsweep
