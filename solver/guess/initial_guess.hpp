// Initial guesses for the CG solve of A dlambda = b, behind one interface.
//
// prepare() is called once before a solve, propose() writes x0, accept() receives the solution, which belongs to the
// same system. Histories are kept per (rod, Newton iteration): a history guess of Newton iteration j extrapolates the
// solutions of iteration j of the last steps,
//   previous  x1,      linear  2 x1 - x2,      quadratic  3 x1 - 3 x2 + x3        (x1 the newest),
// and uses fewer terms, or zero, if consecutive steps have no solution at that iteration.
// A learned guess is one more implementation of this interface.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solver/cg/cg_solver.hpp"
#include "solver/cg/conjugate_gradient.hpp"
#include "solver/factor/block_factor.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

struct Proposal {
  bool nonzero = false;               ///< false: x0 is zero
  int products = 0;                   ///< products with A in the guess itself
  const VectorX* residual = nullptr;  ///< b - A x0, if known; valid until the rod's next proposal
  bool renewed = false;               ///< the guess renewed data that later systems reuse

  /// The start of CG, and the products with A before its first iteration.
  CgStart start() const { return {nonzero, residual}; }
  int start_products() const { return products + (nonzero && !residual ? 1 : 0); }
};

class InitialGuess {
 public:
  virtual ~InitialGuess() = default;
  /// Called once before a system's first propose(): the work that further proposals do not repeat, so it is timed once.
  virtual void prepare(const SolvePosition&) {}
  /// Writes x0. Calling it again for the same system gives the same x0.
  virtual Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) = 0;
  /// Receives the solution of the system last proposed for, which is still assembled and has not yet moved the rod.
  virtual void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) = 0;
  /// Receives the sum of a rod's solutions in a step, before its next step: a better value than the accepted solution of
  /// the step's first system, which no longer exists (totals_guess.hpp). Guesses that store solutions replace it.
  virtual void accept_total(int /*rod*/, int /*step*/, const VectorX& /*total*/) {}
  /// The space that CG projects out of the residuals of the system last proposed for; null: none.
  virtual Deflation* deflation() { return nullptr; }
};

/// Always zero: the denominator of every ratio.
class ZeroGuess : public InitialGuess {
 public:
  Proposal propose(const LinearSystem&, const SolvePosition&, VectorX& x0) override {
    x0.setZero();
    return {};
  }
  void accept(const LinearSystem&, const SolvePosition&, const VectorX&) override {}
};

/// Polynomial extrapolation in time through the last `terms` solutions: 1 previous, 2 linear, 3 quadratic.
class ExtrapolationGuess : public InitialGuess {
 public:
  ExtrapolationGuess(const Scene& scene, int newton_iterations, int terms);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
  void accept_total(int rod, int step, const VectorX& total) override;

 private:
  /// The last solutions of one (rod, Newton iteration), as a ring.
  struct History {
    std::vector<VectorX> solutions;
    int newest = -1;
    int consecutive = 0;  ///< number of consecutive last steps that are stored
    int last_step = -2;
  };
  History& history(const SolvePosition& at);
  int terms_, newton_iterations_;
  std::vector<History> histories_;
};

/// The exact solution plus a random error e of given relative A-norm, ||e||_A = error ||x||_A: the savings of a guess
/// of known quality. It solves the system itself, so its time has no meaning.
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

/// Uses another guess only if sqrt(r^T D^-1 r) of r = b - A x0 is below `threshold` times that of b, D the diagonal
/// of A (the natural norm of Jacobi-preconditioned CG); else zero.
class GuardedGuess : public InitialGuess {
 public:
  GuardedGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner, double threshold);
  void prepare(const SolvePosition& at) override { inner_->prepare(at); }
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override {
    inner_->accept(system, at, solution);
  }
  void accept_total(int rod, int step, const VectorX& total) override { inner_->accept_total(rod, step, total); }
  Deflation* deflation() override { return used_ ? inner_->deflation() : nullptr; }

 private:
  std::unique_ptr<InitialGuess> inner_;
  double threshold_;
  std::vector<VectorX> scratch_;  ///< per rod
  bool used_ = false;             ///< the last proposal of the inner guess
};

/// Uses another guess at the first Newton iteration of a step, zero at the others: for guesses trained on first ones.
class FirstGuess : public InitialGuess {
 public:
  explicit FirstGuess(std::unique_ptr<InitialGuess> inner) : inner_(std::move(inner)) {}
  void prepare(const SolvePosition& at) override {
    if (at.newton == 0) inner_->prepare(at);
  }
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override {
    if (at.newton == 0) inner_->accept(system, at, solution);
  }
  void accept_total(int rod, int step, const VectorX& total) override { inner_->accept_total(rod, step, total); }
  Deflation* deflation() override { return used_ ? inner_->deflation() : nullptr; }

 private:
  std::unique_ptr<InitialGuess> inner_;
  bool used_ = false;  ///< at the last proposal
};

}  // namespace rodsweep
