// COPINGNet as an initial guess: a base guess, and the network's correction of it.
//
//   x0 = x_base + c d,   d = unit * y(features of A, r),   r = b - A x_base,   c = d.r / d.A d (with `best_length`)
// c makes x0 no worse than x_base in the energy norm, whatever the network says. A network that answers with something
// that is not a number, or has nothing to correct, leaves x_base.
#pragma once

#include <memory>
#include <vector>

#include "network/model.hpp"
#include "network/sweeps_inference.hpp"
#include "solver/initial_guess.hpp"

namespace rodsweep {

class CopingNetGuess : public InitialGuess {
 public:
  /// Of the rods of the scene that the solves move: `deck` and `physics` read their state there. Throws SceneError
  /// where sweeps meet joints that close a loop.
  CopingNetGuess(std::shared_ptr<const Model> model, const Scene& scene, double dt_c, int newton_iterations);
  ~CopingNetGuess() override;

  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition& at, const VectorX& solution) override { base_->accept(at, solution); }

 private:
  struct RodBuffers;
  RodBuffers& buffers_of(const LinearSystem& system, int rod);
  void correction(const LinearSystem& system, const SolvePosition& at, const VectorX& x0, RodBuffers& rod);

  std::shared_ptr<const Model> model_;
  const Scene& scene_;
  double dt_c_;
  std::unique_ptr<InitialGuess> base_;
  std::vector<std::unique_ptr<RodBuffers>> rods_;  ///< made at a rod's first solve
};

}  // namespace rodsweep
