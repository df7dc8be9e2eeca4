// What deflated CG projects out of every preconditioned residual (Saad, Yeung, Erhel & Guyomarc'h 2000, SIAM J. Sci.
// Comput. 21): z <- P z, A-orthogonal to a space V in which the first residual has no part left; and what rounding
// brings of V into the residual r is solved for there.
#pragma once

namespace rodsweep {

class Deflation {
 public:
  virtual ~Deflation() = default;
  /// r and z hold as many entries as A has rows. Allocates nothing.
  virtual void project(const double* r, double* z) = 0;
};

}  // namespace rodsweep
