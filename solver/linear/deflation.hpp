// What deflated CG projects out of every preconditioned residual (Saad, Yeung, Erhel & Guyomarc'h 2000, SIAM J. Sci.
// Comput. 21): z <- P z, A-orthogonal to a space V in which the first residual has no part left.
#pragma once

namespace rodsweep {

class Deflation {
 public:
  virtual ~Deflation() = default;
  /// `z` holds as many entries as A has rows. Allocates nothing.
  virtual void project(double* z) = 0;
};

}  // namespace rodsweep
