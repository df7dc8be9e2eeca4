// k nearest neighbours as an initial guess, what Shao et al. 2021 compare their network with (k = 3): the solutions of
// the most similar systems of a training set, resampled to the rod's joints by arc length, averaged with the inverse of
// their distances as weights, and scaled from loads without units (network/guess/chain_profile.hpp) to this rod's sizes
// and time step. Its length is not optimised in the energy norm as that of a COPINGNet's correction: stiff components
// determine that length, and it was measured to need more iterations to loose tolerances.
#pragma once

#include <memory>
#include <vector>

#include "network/guess/knn.hpp"
#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

class KnnGuess : public InitialGuess {
 public:
  /// Of the rods of the scene that the solves move. Throws SceneError where one branches, std::invalid_argument where
  /// there is not one neighbour.
  KnnGuess(std::shared_ptr<const KnnSet> training, const Scene& scene, double dt_c, int neighbours);

  /// Zero for Newton iterations that the training set has no systems of. Allocates nothing.
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition&, const VectorX&) override {}

 private:
  struct RodBuffers {
    ChainProfile profile;
    Tensor<float> state, loads;
  };
  std::shared_ptr<const KnnSet> training_;
  const Scene& scene_;
  double dt_c_;
  std::vector<RodBuffers> rods_;
  KnnSet::Neighbours neighbours_;
};

}  // namespace rodsweep
