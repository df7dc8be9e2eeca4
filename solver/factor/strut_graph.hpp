// A rod as struts between crossings.
//
// Crossings are the segments with more than two joints, those at a joint without arms (where rods cross; also at the
// corners of a net, so that all of its crossings are alike), and one segment of every ring. All other free segments
// form struts: chains from a crossing to another crossing, to a held segment or to a free end. Eliminating the segments
// of a strut couples its two ends. Links are the joints between two crossings, or a crossing and a held segment.
//
// A rod without crossings consists of struts without ends.
#pragma once

#include <vector>

#include "solver/rod/rod.hpp"

namespace rodsweep {

struct Strut {
  int begin = -1, end = -1;   ///< crossings, numbered as in StrutGraph::crossings; -1: none
  std::vector<int> segments;  ///< from begin to end
  std::vector<int> joints;    ///< one more: before, between and after them; -1 at a free end
};

struct StrutGraph {
  std::vector<int> crossings;  ///< segments; those joined by links without arms follow each other
  std::vector<Strut> struts;
  std::vector<int> links;  ///< joints
  std::vector<int> place;  ///< of each segment among the crossings, -1 for others
};

StrutGraph strut_graph(const Rod& rod);

}  // namespace rodsweep
