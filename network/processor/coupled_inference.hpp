// The learned factors of network/processor/coupled_factors.hpp for one rod at a time: no allocation, no tape.
//
// Factors are predicted for all joints at once, in canonical frames, and transformed to the joints' frames: with
// P_k = T_k S_k, the transformation to a canonical frame and the scale in it (network/encoding/canonical_frames.hpp),
//   N_k <- P_k^T N_k P_k,   T_ks <- P_k^T T_ks P_k
// so that a solve uses residuals without scaling and A's own blocks in single precision, in the two passes of
// network/processor/coupled_passes.hpp. Layers have operands of 16 bits (network/layers/narrow_product.hpp). The
// results differ from the training code's in rounding, and where that code drops a state
// (CoupledPasses::longest_state).
#pragma once

#include "network/encoding/canonical_frames.hpp"
#include "network/layers/narrow_product.hpp"
#include "network/processor/coupled_factors.hpp"

namespace rodsweep {

class CoupledInference {
 public:
  /// Whether there are kernels for a latent size: multiples of 16.
  static bool supports(int latent) { return latent > 0 && latent % 16 == 0; }

  /// Throws std::invalid_argument for a latent size without kernels. `pattern` must outlive this.
  CoupledInference(const CoupledFactors<float>& factors, const Parameters<float>& weights,
                   const SystemPattern& pattern);

  /// Sets the factors of a matrix from its blocks and frames.
  void factorise(const CanonicalFrames& frames, const BlockMatrix& a);

  /// Sets d to the factors' solution for a residual r of the matrix.
  void solve(const VectorX& r, VectorX& d);

 private:
  using Lane16 = float __attribute__((vector_size(64)));
  /// Columns 2 q and 2 q + 1, in lanes 0..5 and 8..13.
  struct alignas(64) Joint {
    Lane16 n[3], t[2][3], t_transposed[2][3];
    int first_coupling = 0;
    int sides = 0;  ///< number of sides with earlier places
  };
  struct alignas(64) Coupling {
    Lane16 b[3], b_transposed[3];
  };
  void see(const CanonicalFrames& frames, const BlockMatrix& a);
  void send_messages();
  template <class Start>
  void activate(const Start& start, NarrowColumns* out);
  void form(int place, const CanonicalFrames& frames);
  int end_of(int place) const;

  const SystemPattern& pattern_;
  NarrowMatrix message_, encode_, join_, join_again_, last_;
  Tensor<float> start_;  ///< [H, places] V t + b
  Eigen::VectorXf message_bias_, join_bias_, join_again_bias_, last_bias_;
  NarrowColumns b_, x_, e_, f_, g_;         ///< [36, couplings]; [4 H + 21, places]; 3 H twice; H
  Tensor<float> messages_, before_, sums_;  ///< [2 H, couplings]; [H, places]; [4 H, places]
  Tensor<float> factors_;                   ///< [96, places]
  std::vector<Joint> joints_;
  std::vector<Coupling> couplings_;
  std::vector<Lane16> h_, d_;  ///< states, in both halves
};

}  // namespace rodsweep
