// The linear system of a Newton iteration, condensed to the motions of the segments where rods cross.
//
// A d = r with A = J M^-1 J^T + alpha~ is the equation of the correction d of multipliers with residual r. In terms of
// the motions y of d, M y = J^T d, it is
//   K y = J^T C r,   K = M + J^T C J,   C = alpha~^-1,   d = C (r - J y)
// (Woodbury). K couples segments that share a joint, so struts (strut_graph.hpp) are eliminated exactly, one after the
// other, and a matrix S of the crossings remains,
//   S y_c = g,   S = K_cc - K_ci K_ii^-1 K_ic,   g = f_c - K_ci K_ii^-1 f_i,   f = J^T C r
// (static condensation: Guyan 1965; Przemieniecki 1963). If struts are long, it has far fewer rows than A. It has no
// self-stresses, and struts are solved exactly. With p = g - S y_c, which is zero in struts, the residual of A is
//   r - A d = -J M^-1 p,
// without a product with A. Stretch and bending must have a compliance above zero. Nearly inextensible rods lose digits
// in the ratio of alpha~ to J M^-1 J^T. M is stiffened in iterations that keep the balance of momentum.
//
// Struts with the same number of segments are eliminated together, one per lane. Nothing allocates after construction.
#pragma once

#include <array>
#include <vector>

#include "solver/factor/strut_graph.hpp"
#include "solver/linear/block_matrix.hpp"
#include "solver/numbers/lane_blocks.hpp"
#include "solver/rod/linearization.hpp"

namespace rodsweep {

class Condensation {
 public:
  explicit Condensation(const Rod& rod);

  /// Assembles S of a rod's linearization. Returns false if M or K is not positive definite.
  bool assemble(const Rod& rod, const Linearization& linearization, double dt);

  const BlockMatrix& matrix() const { return matrix_; }  ///< S, a block row per crossing

  /// Sets g from a residual r, six per joint.
  void condense(const VectorX& r, VectorX& g);

  /// Sets d for the residual last condensed, from y_c.
  void expand(const VectorX& r, const double* y, VectorX& d);

  /// Sets g from forces and torques on one segment, six rows with a right-hand side per lane.
  void load(int segment, const Lane8 (&force)[6], std::vector<Lane8>& g);
  /// The motion of a segment by the load, from y_c.
  void motion_of(int segment, const std::vector<Lane8>& y, Lane8 (&out)[6]) const;

  /// |J M^-1 p|, p six per crossing.
  double residual_norm(const double* p) const;

 private:
  /// Struts with the same number of segments, one in each lane; unused lanes repeat the last.
  struct Batch {
    std::size_t first_strut, first_inner;
    int count, segments;
  };
  /// The block of a segment of each strut after the elimination of those before it.
  struct Inner {
    LaneFactor factor;
    LaneVector6 to_begin[6], to_next[6];  ///< solutions for the columns that couple it to the strut's begin,
                                          ///< and to the next segment or the strut's end
    LaneVector6 f;
  };
  /// Where a segment of a strut is.
  struct Home {
    int batch = -1, lane = 0, segment = 0;
  };
  /// Blocks of S.
  struct Places {
    int begin, end, begin_end, end_begin;
  };

  const Strut& strut(const Batch& batch, int lane) const;
  LaneMask eliminate(const Batch& batch);
  void add(const Places& to, int lane, const LaneBlock& begin, const LaneBlock& end, const LaneVector6 (&end_begin)[6]);
  void add_links();
  void condense(const Batch& batch);
  void expand(const Batch& batch);

  StrutGraph graph_;
  BlockMatrix matrix_;
  std::vector<Places> places_;  ///< of each strut, then of each link
  std::vector<int> near_;       ///< joints of crossings
  std::vector<Batch> batches_;
  std::vector<Inner> inner_;
  std::vector<Home> home_;  ///< of each segment
  // From the last assembly:
  const Rod* rod_ = nullptr;
  const Linearization* linearization_ = nullptr;
  std::vector<Lane8> stiffness_;     ///< C of each joint
  std::vector<Lane8> inverse_mass_;  ///< of each segment
  std::vector<Lane8> motion_;        ///< f, then y, of each segment
  // From the last load:
  Home loaded_;
  std::vector<std::array<Lane8, 6>> loads_;  ///< f of the loaded segment and of those after it in its strut
};

}  // namespace rodsweep
