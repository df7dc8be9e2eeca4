// The projection of deflated CG around its preconditioner M (Saad, Yeung, Erhel & Guyomarc'h 2000, SIAM J. Sci. Comput.
// 21): the solution in a space V is exact, and M is applied to the rest,
//   z = P M^-1 P^T r + Q r,   Q = V E^-1 V^T,   E = V^T A V,   P = I - Q A.
// If the first residual is orthogonal to V, P^T r and Q r differ from r and 0 only by rounding. Without these terms the
// rounding may grow: z = P M^-1 r ignores it, and z = P M^-1 r + Q r (A-DEF2) removes alpha times it, with CG's step
// alpha. This variant is symmetric (BNN in Tang, Nabben, Vuik & Erlangga 2009, J. Sci. Comput. 39).
#pragma once

namespace rodsweep {

class Deflation {
 public:
  virtual ~Deflation() = default;
  /// r <- P^T r, then z <- P z + Q r with that r; as many entries as A has rows. Allocates nothing.
  virtual void reduce(double* r) = 0;
  virtual void complete(double* z) = 0;
};

}  // namespace rodsweep
