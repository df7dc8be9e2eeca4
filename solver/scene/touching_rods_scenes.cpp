#include <algorithm>
#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

constexpr double golden_turn = 2.39996322972865332;  // the golden angle [rad]

/// The first positions of a hexagonal lattice of unit distance, ring by ring from the middle.
std::vector<Vector3> hexagonal_places(int count) {
  std::vector<Vector3> places{Vector3::Zero()};
  for (int ring = 1; static_cast<int>(places.size()) < count; ++ring)
    for (int side = 0; side < 6; ++side)
      for (int i = 0; i < ring; ++i) {
        const double at = side * pi / 3, along = at + 2 * pi / 3;
        places.push_back(ring * Vector3(std::cos(at), 0, std::sin(at)) +
                         i * Vector3(std::cos(along), 0, std::sin(along)));
      }
  places.resize(at(count));
  return places;
}

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

void FallingRods::check() const {
  check_least("rods", rods, 1);
  check_least("segments", segments, 2);
  if (!(height_m >= 2 * radius_m))
    throw SceneError("height_m is " + std::to_string(height_m) + "; must be at least 2 radius_m, or the rods overlap");
  check_segments("a heap", static_cast<double>(rods) * segments);
}

SceneSize FallingRods::size() const { return {rods * segments, rods * (segments - 1), rods}; }

// Centres are off the axis by a tenth of the length, all to different sides, so that a heap forms rather than a stack.
void FallingRods::build(Scene& scene) const {
  for (int k = 0; k < rods; ++k) {
    const double angle = k * turn_deg * pi / 180, side = k * golden_turn;
    const Vector3 half = length_m / 2 * Vector3(std::cos(angle), 0, std::sin(angle));
    const Vector3 centre(length_m / 10 * std::cos(side), radius_m + (k + 1) * height_m, length_m / 10 * std::sin(side));
    const std::vector<SegmentSpec> rod = segments_through(straight_line(centre - half, centre + half, segments), *this);
    scene.rods.push_back(chain(rod, *this, weight(rod, *this)));
  }
  scene.obstacles.emplace_back(HalfSpace{});
}

void Bundle::check() const {
  check_least("rods", rods, 1);
  check_least("segments", segments, 2, ": the first ones are held");
  if (!(initial_angle_deg >= 0 && initial_angle_deg <= 90))
    throw SceneError("initial_angle_deg is " + std::to_string(initial_angle_deg) +
                     "; must be from 0 to 90 for a bundle, whose rods must not cross");
  check_segments("a bundle", static_cast<double>(rods) * segments);
}

SceneSize Bundle::size() const { return {rods * segments, rods * (segments - 1), rods}; }

void Bundle::build(Scene& scene) const {
  const std::vector<Vector3> places = hexagonal_places(rods);
  const double widest = std::max(1.0, places.back().norm());
  for (const Vector3& place : places) {
    const double angle = initial_angle_deg * pi / 180 * place.norm() / widest;
    const Vector3 outwards = place.isZero() ? Vector3(0, 0, 0) : Vector3(place.normalized());
    const Vector3 top = 2.1 * radius_m * place;
    const Vector3 along = std::sin(angle) * outwards - std::cos(angle) * Vector3::UnitY();
    std::vector<SegmentSpec> rod = segments_through(straight_line(top, top + length_m * along, segments), *this);
    rod.front().is_static = true;
    scene.rods.push_back(chain(rod, *this, weight(rod, *this)));
  }
}

void CoilingRod::check() const { check_least("segments", segments, 2, ": the first one is held"); }

SceneSize CoilingRod::size() const { return {segments, segments - 1}; }

void CoilingRod::build(Scene& scene) const {
  std::vector<Vector3> vertices;
  for (int i = 0; i <= segments; ++i) {
    const double along = static_cast<double>(i) / segments, turn = 2 * pi * along / 100;
    vertices.emplace_back(radius_m * (std::cos(turn) - 1), height_m + radius_m + length_m * (1 - along),
                          radius_m * std::sin(turn));
  }
  std::vector<SegmentSpec> rod = segments_through(vertices, *this);
  rod.front().is_static = true;
  scene.rods.push_back(chain(rod, *this, weight(rod, *this), true));
  scene.obstacles.emplace_back(HalfSpace{});
  move_clamp(scene, 0, Vector3(0, -feed_m_s, 0));
}

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
