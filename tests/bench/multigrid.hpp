// PETSc's algebraic multigrids as preconditioners of A, for comparison with ours: GAMG (smoothed aggregation) and
// hypre's BoomerAMG (systems of six unknowns, "unknown" approach).
//
// GAMG's near null space: the same force or moment in every joint, lambda = (l R^T f, R^T m). R is the frame of the
// joint's second segment, l the length of the joint.
#pragma once

#include <memory>

#include "solver/linear/linear_system.hpp"

namespace rodsweep::bench {

class Multigrid {
 public:
  enum class Kind { gamg, boomer };

  Multigrid(Kind kind, const Rod& rod, const LinearSystem& system);
  ~Multigrid();
  Multigrid(const Multigrid&) = delete;
  Multigrid& operator=(const Multigrid&) = delete;

  void set_up();
  void apply(const VectorX& r, VectorX& z);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rodsweep::bench
