// k nearest neighbours as an initial guess, the comparison of Shao et al. 2021 (k = 3). The solutions of the most
// similar systems of a training set are resampled to the rod's joints by arc length and averaged with weights of
// inverse distance. Loads without units (network/guess/chain_profile.hpp) are scaled to this rod's sizes and time step.
// Unlike a COPINGNet's correction, the guess is not scaled by the best length in the energy norm: stiff components
// determine that length, and in measurements it costs more iterations to loose tolerances.
#pragma once

#include <memory>
#include <vector>

#include "network/guess/knn.hpp"
#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

class KnnGuess : public InitialGuess {
 public:
  /// `scene` is the one that the solves move. Throws SceneError if a rod is not a chain, and
  /// std::invalid_argument if neighbours < 1.
  KnnGuess(std::shared_ptr<const KnnSet> training, const Scene& scene, int neighbours);

  /// Proposes zero for Newton iterations without systems in the training set. Allocates nothing.
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem&, const SolvePosition&, const VectorX&) override {}

 private:
  struct RodBuffers {
    ChainProfile profile;
    Tensor<float> state, loads;
  };
  std::shared_ptr<const KnnSet> training_;
  const Scene& scene_;
  std::vector<RodBuffers> rods_;
  KnnSet::Neighbours neighbours_;
};

}  // namespace rodsweep
