#include <algorithm>
#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

constexpr double depth = 1.2;  // of the crossings
constexpr double aside = 0.5;  // distance at which the ends pass each other
constexpr double leading = 4;  // length of the straight ends

/// A trefoil, (sin t + 2 sin 2t, cos t - 2 cos 2t, -depth sin 3t), opened at (0, -3, 0), where it runs along x.
Vector3 trefoil(double t) {
  const double u = t / pi - 2, level = 1 - std::pow(u, 8);  // the ends run level
  return {std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t),
          -depth * std::sin(3 * t) * level - aside * u};
}

/// The whole curve, finely sampled.
std::vector<Vector3> fine_knot() {
  constexpr int pieces = 2000;
  std::vector<Vector3> curve{trefoil(pi) - Vector3(leading, 0, 0)};
  for (int i = 0; i <= pieces; ++i) curve.push_back(trefoil(pi * (1 + 2.0 * i / pieces)));
  curve.push_back(trefoil(3 * pi) + Vector3(leading, 0, 0));
  return curve;
}

double length(const std::vector<Vector3>& curve) {
  double sum = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) sum += (curve[i] - curve[i - 1]).norm();
  return sum;
}

/// Vertices at equal distances along the curve, which becomes `length_m` long.
std::vector<Vector3> cut(const std::vector<Vector3>& curve, int pieces, double length_m) {
  const double whole = length(curve);
  std::vector<Vector3> vertices{curve.front()};
  double gone = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double step = (curve[i] - curve[i - 1]).norm();
    while (static_cast<int>(vertices.size()) < pieces &&
           gone + step >= whole * static_cast<double>(vertices.size()) / pieces) {
      const double part = (whole * static_cast<double>(vertices.size()) / pieces - gone) / step;
      vertices.push_back(curve[i - 1] + part * (curve[i] - curve[i - 1]));
    }
    gone += step;
  }
  vertices.push_back(curve.back());
  for (Vector3& vertex : vertices) vertex *= length_m / whole;
  return vertices;
}

/// The least length of a loose knot, in radii.
double loose_knot_radii() {
  // Strands cross at a distance of at least 2.1 radii.
  static const double radii = [] {
    constexpr int pieces = 400;
    const std::vector<Vector3> curve = cut(fine_knot(), pieces, 1);
    double nearest = 1;
    for (std::size_t i = 0; i < curve.size(); ++i)
      for (std::size_t j = i + pieces / 10; j < curve.size(); ++j)
        nearest = std::min(nearest, (curve[i] - curve[j]).norm());
    return 2.1 / nearest;
  }();
  return radii;
}

}  // namespace

void Knot::check() const {
  check_least("segments", segments, 30, ": fewer do not make a knot");
  const double shortest = loose_knot_radii() * radius_m;
  if (!(length_m >= shortest))
    throw SceneError("length_m is " + std::to_string(length_m) + "; must be at least " + std::to_string(shortest) +
                     " for a loose knot of this radius_m");
}

SceneSize Knot::size() const { return {segments, segments - 1}; }

void Knot::build(Scene& scene) const {
  std::vector<SegmentSpec> rod = segments_through(cut(fine_knot(), segments, length_m), *this);
  rod.front().is_static = rod.back().is_static = true;
  const double tightest = 4 * stiffness(*this).bending_x_nm2 / (radius_m * radius_m);  // 16 EI / (2 r)^2
  scene.rods.push_back(chain(rod, *this, weight(rod, *this) + tightest, true));
  move_clamp(scene, 0, Vector3(-pull_m_s, 0, 0));
  move_clamp(scene, segments - 1, Vector3(pull_m_s, 0, 0));
}

}  // namespace rodsweep
