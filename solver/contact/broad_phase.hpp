// Which bodies may touch in a step: all pairs whose boxes meet, from an R-tree (Boost.Geometry) that is packed at once
// (Leutenegger et al. 1997; Garcia et al. 1998) and asked for every box: O(n log n) in all.
//
// Boxes are kept larger than asked for by a margin, and the pairs with them, until a box leaves its own (a Verlet
// list): bodies that move slowly cost a comparison each. Pairs come sorted. Only finding them anew allocates.
#pragma once

#include <functional>
#include <vector>

#include "solver/numbers/types.hpp"

namespace rodsweep {

struct Box {
  Vector3 low, high;

  void include(const Vector3& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  Box grown(double by) const { return {low.array() - by, high.array() + by}; }
  bool contains(const Box& other) const {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

struct Pair {
  int a, b;  ///< a < b
};

class BroadPhase {
 public:
  /// `matters(a, b)`, a < b: whether the pair is wanted. `margins`: of every body [m].
  BroadPhase(std::vector<double> margins, std::function<bool(int, int)> matters);

  /// At least all pairs that matter and whose boxes meet, at most those whose boxes grown by twice the margins do.
  const std::vector<Pair>& pairs(const std::vector<Box>& boxes);

  int searches() const { return searches_; }  ///< how often pairs were found anew

 private:
  void search();

  std::vector<double> margins_;
  std::function<bool(int, int)> matters_;
  std::vector<Box> kept_;
  std::vector<Pair> pairs_;
  int searches_ = 0;
};

}  // namespace rodsweep
