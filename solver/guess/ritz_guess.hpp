// Recycled Ritz vectors: approximate eigenvectors W of A y = theta M y for the smallest theta, M CG's preconditioner,
// taken from earlier solves of the same rod. CG finds these components last. Another guess x1 starts at
//   x0 = x1 + W (W^T A W)^-1 W^T (b - A x1),
// and CG projects W out of its residuals (galerkin_projection.hpp). This is deflated CG with recycling (Saad, Yeung,
// Erhel & Guyomarc'h 2000, SIAM J. Sci. Comput. 21), as eigCG does it for one matrix (Stathopoulos & Orginos 2010).
//
// From a solve it collects the residuals r and preconditioned residuals z = M^-1 r, which span the Krylov space. After
// every `collected` of them, and at the end, a Rayleigh-Ritz step in the basis V = [Ritz vectors, collected z],
//   V^T A V c = theta V^T (M V) c,
// makes V C the new Ritz vectors (a thick restart). M V is known without another product, as M z = r. Combinations of V
// that are only rounding are dropped. A step costs as many products with A as V has vectors, in one pass.
//
// Solves are collected every `lag_steps` time steps. A system may be proposed for and solved several times: each
// proposal collects anew, so only the last solve before accept() is learned from. Products that a proposal counts: one per Ritz vector, and one if
// the residual of x1 is not known. Those of the Rayleigh-Ritz steps are not counted, but their time is: in the solve and
// in accept(). Only these steps allocate, in Eigen's eigenvalue solver.
#pragma once

#include <Eigen/Eigenvalues>
#include <vector>

#include "solver/guess/galerkin_projection.hpp"
#include "solver/guess/wrapped_guess.hpp"

namespace rodsweep {

class RitzGuess : public WrappedGuess, private Deflation {
 public:
  /// `size` Ritz vectors and `collected` residuals, both at least 1; lag_steps of 0: a step after every solve.
  RitzGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner, int size, int collected, int lag_steps);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
  Deflation* deflation() override { return this; }

  /// theta of a rod's Ritz vectors, ascending.
  const std::vector<double>& ritz_values(int rod) const { return spaces_[at(rod)].begun.values; }

 private:
  /// V begins with `size` Ritz vectors; unused ones are zero.
  struct Basis {
    StoredVectors vectors;
    Eigen::MatrixXd images;      ///< M V
    std::vector<double> values;  ///< theta of the Ritz vectors in V
  };
  /// Of one rod.
  struct Space {
    StoredVectors ritz, products;  ///< W, A W: what CG projects out
    int known = 0;                 ///< of W
    Basis begun, basis;            ///< as of the last accepted solve; of the solve that is collected
    bool changed = false;          ///< `basis` differs from `begun`
    Eigen::MatrixXd combined;      ///< scratch for new Ritz vectors
    VectorX residual, scratch;
    int next_step = 0;  ///< the first whose solve is collected
  };
  /// False, and nothing is changed, if a number is not finite.
  bool rayleigh_ritz(Space& space, const BlockMatrix& a);
  /// Sets combinations_ to those of V that are orthonormal in V^T M V, and dropped_. False if a number is not finite.
  bool orthonormalise(Space& space);
  void restart(Space& space, int kept);
  void reduce(double* r) override;
  void complete(double* z) override;

  int size_, most_collected_, lag_steps_;
  std::vector<Space> spaces_;
  Eigen::VectorXi order_;
  GalerkinProjection projection_;

  // Of the system last proposed for.
  Space* space_ = nullptr;
  const BlockMatrix* matrix_ = nullptr;
  bool collecting_ = false;
  int collected_ = 0;

  Eigen::MatrixXd gram_, mass_, combinations_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  std::vector<bool> dropped_;
  VectorX coefficients_;
};

}  // namespace rodsweep
