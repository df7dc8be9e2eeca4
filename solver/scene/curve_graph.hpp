// Curves as a graph: their points joined to nodes where curves meet, and the rest cut into edges, each of which becomes a
// segment.
//
// Points within a tolerance of each other move to their middle and are one node; also the ends of a curve that is closed
// by them, of more than three points. So are held points, and all points of a curve without a spline. Between two nodes a
// curve is cut into equal pieces, straight or along a centripetal Catmull-Rom spline through its points (Barry & Goldman
// 1988). A piece between two nodes of three or more edges is cut in two, one from a node to itself in three.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solver/numbers/types.hpp"

namespace rodsweep {

/// A line through points. What is empty is that of the scene.
struct Curve {
  std::string name;  ///< in errors: "curve 2"
  std::vector<Vector3> points;
  std::vector<double> radii;  ///< at each point; empty: that of the scene
  std::optional<double> youngs_modulus_pa, torsion_modulus_pa, density_kg_m3;
};

struct CurveEdge {
  int curve = 0, from = 0, to = 0;  ///< nodes
  Vector3 from_m, to_m;
  double from_radius, to_radius;
};

struct CurveGraph {
  struct Node {
    Vector3 position_m;
    bool held = false;
    std::vector<int> edges;  ///< that begin or end here
  };
  std::vector<Node> nodes;
  std::vector<CurveEdge> edges;  ///< in the order of the curves and along each
  std::vector<int> component;    ///< of every node, from 0
  int components = 0;
};

enum class Interpolation { linear, spline };
enum class HeldPoints { none, ends };  ///< ends: nodes of one edge

struct CurveCut {
  Interpolation interpolation = Interpolation::linear;
  double segment_m = 0;  ///< greatest length of an edge; 0: from point to point
  double join_m = 0;     ///< tolerance of meeting points; 0: a millionth of the extent
  HeldPoints held = HeldPoints::none;
  std::vector<Vector3> held_at_m;  ///< in addition
};
bool operator==(const CurveCut& a, const CurveCut& b);

/// Throws SceneError for a point at that of the one before, a spline through less than four points, or a held point that
/// is away from all points. `radius`: of curves without radii.
CurveGraph cut(std::vector<Curve> curves, double radius, const CurveCut& how);

/// How far points move to meet [m], at most. Throws as cut().
double joining_shift(const std::vector<Curve>& curves, double join_m);

}  // namespace rodsweep
