// The Delassus operator of a rod: H of rod_response.hpp between the segments that contacts touch, in 6x6 blocks. The
// motion of every touched segment follows from an impulse on one of them without the rest of the rod.
//
// t touched segments cost 6 t substitutions with the factor and t^2 blocks of 384 bytes, so their number is limited.
// Allocates only for more touched segments than before.
#pragma once

#include <vector>

#include "solver/contact/rod_response.hpp"

namespace rodsweep {

class DelassusOperator {
 public:
  DelassusOperator(int segments, int most_touched) : most_touched_(at(most_touched)), place_(at(segments), -1) {}

  /// Forgets all segments: the response was assembled anew.
  void clear();

  /// Adds a segment, unless it is there or is one too many.
  void touch(int segment);

  /// Finds the blocks of segments that were added since the last call.
  void update(const Rod& rod, RodResponse& response);

  bool is_full() const { return is_full_; }  ///< a touched segment was one too many: the blocks are of no use

  /// The motion of a touched segment by a force and a torque on another: dx and dtheta in the world.
  const Block6& block(int of, int by) const { return blocks_[place(by) * stride_ + place(of)]; }

 private:
  std::size_t place(int segment) const { return at(place_[at(segment)]); }
  void grow();

  std::size_t most_touched_;
  std::vector<int> place_;  ///< of every segment of the rod among those touched, or -1
  std::vector<int> touched_;
  std::size_t known_ = 0;               ///< touched segments with blocks
  std::size_t stride_ = 0;              ///< blocks in a column
  std::vector<Block6> blocks_, grown_;  ///< columns; room to copy them
  bool is_full_ = false;
};

}  // namespace rodsweep
