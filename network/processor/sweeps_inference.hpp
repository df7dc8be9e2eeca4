// The two sweeps of network/processor/sweeps.hpp for one rod at a time, as an initial guess needs them: no allocation,
// no tape.
//
// What can be done for all joints at once is a product (network/layers/product.hpp); only U h waits for the joint
// before, and there all three gates stay in registers. The results differ from the training code's in rounding alone.
#pragma once

#include "network/processor/sweeps.hpp"

namespace rodsweep {

class SweepsInference {
 public:
  /// Whether there are kernels for a latent size: 16, 32, 48 or 64.
  static bool supports(int latent) { return latent > 0 && latent <= 64 && latent % 16 == 0; }

  /// std::invalid_argument for a latent size without kernels. `weights` must outlive this.
  SweepsInference(const Sweeps<float>& sweeps, const Parameters<float>& weights, int joints);

  /// x [features, joints] -> y [outputs, joints], in the order of the forest.
  void run(const JointForest& forest, const TensorIn<float>& x, Eigen::Ref<Tensor<float>> y);

 private:
  using Step = void (*)(const float* u, const float* p, const float* h, float* out);
  Sweeps<float>::Layers layers_;
  const Parameters<float>& weights_;
  Step step_;
  bool linear_;
  Tensor<float> states_;    ///< [3 H, joints]: e, then both sweeps' states: what a product needs lies together
  Tensor<float> gates_;     ///< [3 H or 2 H, joints]: the gates' part that needs no recurrence
  Tensor<float> incoming_;  ///< [H, joints]: sums of the children's states
  Tensor<float> hidden_;    ///< [H, joints] of the decoder
};

}  // namespace rodsweep
