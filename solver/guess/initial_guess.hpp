// Initial guesses for the CG solve of A dlambda = b, behind one interface.
//
// prepare() is called once before a solve, propose() writes x0, accept() receives the solution, which belongs to the
// same system. Every guess is one more implementation of this interface, also a learned one.
#pragma once

#include "solver/cg/cg_solver.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

struct Proposal {
  bool nonzero = false;               ///< false: x0 is zero
  int products = 0;                   ///< products with A in the guess itself
  const VectorX* residual = nullptr;  ///< b - A x0, if known; valid until the rod's next proposal
  bool renewed = false;               ///< the guess renewed data that later systems reuse
  bool with_network = false;          ///< a network ran

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
  /// the step's first system, which no longer exists (TotalsGuess). Guesses that store solutions replace it.
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

}  // namespace rodsweep
