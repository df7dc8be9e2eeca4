// The exact solution plus a random error e of given relative A-norm, ||e||_A = error ||x||_A: the savings of a guess
// of known quality. It solves the system itself, so its time has no meaning.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/factor/block_factor.hpp"
#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

class OracleGuess : public InitialGuess {
 public:
  /// With w of independent standard normal entries: white, e ~ w; smooth, e ~ A^-1 w, dominated by the modes of the
  /// smallest eigenvalues, which vary slowly along the rod and which CG finds last.
  enum class Error { white, smooth };
  OracleGuess(const Scene& scene, double error, Error kind, std::uint64_t seed);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem&, const SolvePosition&, const VectorX&) override {}

 private:
  std::vector<BlockFactor> factors_;  ///< per rod
  double error_;
  Error kind_;
  std::uint64_t seed_;
  std::vector<VectorX> noise_, scratch_;  ///< per rod
};

}  // namespace rodsweep
