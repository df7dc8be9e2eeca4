// What deflated CG puts around its preconditioner M (Saad, Yeung, Erhel & Guyomarc'h 2000, SIAM J. Sci. Comput. 21): a
// space V is solved in exactly, and M sees what is left,
//   z = P M^-1 P^T r + Q r,   Q = V E^-1 V^T,   E = V^T A V,   P = I - Q A.
// Where the first residual has no part in V, P^T r and Q r differ from r and 0 by rounding alone. Without them it may
// grow: z = P M^-1 r never sees it, and z = P M^-1 r + Q r (A-DEF2) takes it away alpha times, CG's step, which may be
// anything. This one is symmetric (BNN in Tang, Nabben, Vuik & Erlangga 2009, J. Sci. Comput. 39).
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
