// The pairs of bodies that may touch in a step: all pairs with overlapping boxes, from a packed R-tree (Boost.Geometry;
// Leutenegger et al. 1997; Garcia et al. 1998) with a query for every box: O(n log n) in total.
//
// Boxes are enlarged by a margin, and by several times their motion since the last call. They and their pairs are kept
// until a box leaves its enlarged box (a Verlet list): a comparison each. Pairs are sorted. Only a new search allocates.
#pragma once

#include <functional>
#include <vector>

#include "solver/numbers/types.hpp"

namespace rodsweep {

using Box = Eigen::AlignedBox3d;

/// Enlarged on every side by this length [m].
inline Box grown(const Box& box, double by) { return {box.min().array() - by, box.max().array() + by}; }

struct Pair {
  int a, b;  ///< a < b
};

class BroadPhase {
 public:
  /// `matters(a, b)`, a < b: whether the pair is searched for. `margins`: of every body [m].
  BroadPhase(std::vector<double> margins, std::function<bool(int, int)> matters);

  /// All pairs that matter with overlapping boxes, and some whose enlarged boxes overlap.
  const std::vector<Pair>& pairs(const std::vector<Box>& boxes);

  int searches() const { return searches_; }  ///< searches so far

 private:
  void search();

  std::vector<double> margins_;
  std::function<bool(int, int)> matters_;
  std::vector<Box> kept_;
  std::vector<Box> last_;  ///< of the last call
  std::vector<Pair> pairs_;
  int searches_ = 0;
};

}  // namespace rodsweep
