// A network replaces the solve ("end to end" in Shao et al. 2021): its increments move the rod without a check.
//
// In every Newton iteration   lambda += Delta lambda,   x += R u,   q <- normalise(q + q [0, phi] / 2)
// on free segments; static ones do not move. The system is assembled for the network's features and for Newton's test.
#pragma once

#include <memory>
#include <vector>

#include "network/guess/coping_net_correction.hpp"

namespace rodsweep {

/// One Newton iteration's increments without a solve.
class IncrementSource {
 public:
  virtual ~IncrementSource() = default;
  /// Sets Delta lambda and the segments' moves (u in lanes 0..2, phi in lanes 3..5, in their own frames) for the system
  /// assembled at the rod's state. Returns false if they are not finite.
  virtual bool predict(const Rod& rod, const LinearSystem& system, const SolvePosition& at, VectorX& delta_lambda,
                       std::vector<Lane8>& moves) = 0;
};

/// The increments of a COPINGNet: its base guess, whose history is that of the increments, plus its correction. The
/// network predicts the moves (CopingNetSettings::moves), or they are M^-1 J^T Delta lambda.
class CopingNetIncrements : public IncrementSource {
 public:
  CopingNetIncrements(std::shared_ptr<const Model> model, const Scene& scene, int newton_iterations);
  bool predict(const Rod& rod, const LinearSystem& system, const SolvePosition& at, VectorX& delta_lambda,
               std::vector<Lane8>& moves) override;

 private:
  std::shared_ptr<const Model> model_;
  std::unique_ptr<InitialGuess> base_;
  std::vector<std::unique_ptr<CopingNetCorrection>> corrections_;  ///< made at a rod's first iteration
};

class EndToEndProjection : public Projection {
 public:
  EndToEndProjection(const Scene& scene, std::unique_ptr<IncrementSource> source);

  /// Returns `converged` if it applied the increments, and `not_a_number`, with the rod unchanged, if the residual, the
  /// increments or the moves are not finite. Allocates nothing after a rod's first iterations.
  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) override;

 private:
  struct RodBuffers {
    LinearSystem system;
    VectorX delta_lambda;
    std::vector<Lane8> moves;
  };
  std::unique_ptr<IncrementSource> source_;
  std::vector<RodBuffers> rods_;
};

}  // namespace rodsweep
