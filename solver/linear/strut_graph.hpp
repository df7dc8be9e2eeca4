// A rod as struts between crossings.
//
// Crossings are the segments that the others cannot be told from one after the other: those with more than two joints,
// those at a joint without arms (where rods cross; also at the corners of a net, so that all of its crossings look
// alike), and one of every ring. All other segments that move form struts: chains from a crossing to a crossing, to a
// segment that is held, or to a free end. What joints leave of a strut once its segments are eliminated couples the two
// ends; links are the joints that have a crossing at both sides, or a crossing and a segment that is held.
//
// A rod without crossings is one strut or several without ends.
#pragma once

#include <utility>
#include <vector>

#include "solver/rod/rod.hpp"

namespace rodsweep {

struct Strut {
  int begin = -1, end = -1;   ///< crossings, counted as in StrutGraph::crossings; -1: none
  std::vector<int> segments;  ///< from begin to end
  std::vector<int> joints;    ///< one more: before, between and after them; -1 at a free end
};

struct StrutGraph {
  std::vector<int> crossings;  ///< segments; those of one node follow each other
  std::vector<int> node;       ///< of each crossing: joined by links without arms
  std::vector<Strut> struts;
  std::vector<int> links;  ///< joints
  std::vector<int> place;  ///< of each segment among the crossings, -1 of others

  int nodes() const { return node.empty() ? 0 : node.back() + 1; }
};

StrutGraph strut_graph(const Rod& rod);

}  // namespace rodsweep
