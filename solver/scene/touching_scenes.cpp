#include <cmath>

#include "solver/scene/scene_rods.hpp"

namespace rodsweep {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double golden_turn = 2.39996322972865332;  // of the sunflower's seeds

/// A straight line from one point to another, cut into equal pieces.
std::vector<Vector3> line(const Vector3& from, const Vector3& to, int pieces) {
  std::vector<Vector3> vertices;
  for (int i = 0; i <= pieces; ++i) vertices.push_back(from + static_cast<double>(i) / pieces * (to - from));
  return vertices;
}

Rod moved(Rod rod, const Quaternion& turn, const Vector3& shift) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    rod.position[s] = turn * rod.position[s] + shift;
    rod.orientation[s] = (turn * rod.orientation[s]).normalized();
  }
  return rod;
}

/// The first places of a hexagonal lattice, of unit distance, from the middle outwards ring by ring.
std::vector<Vector3> hexagonal_places(int count) {
  std::vector<Vector3> places{Vector3::Zero()};
  for (int ring = 1; static_cast<int>(places.size()) < count; ++ring)
    for (int side = 0; side < 6; ++side)
      for (int i = 0; i < ring; ++i) {
        const double at = side * pi / 3, along = at + 2 * pi / 3;
        places.push_back(ring * Vector3(std::cos(at), 0, std::sin(at)) +
                         i * Vector3(std::cos(along), 0, std::sin(along)));
      }
  places.resize(static_cast<std::size_t>(count));
  return places;
}

}  // namespace

// Centres are off the axis by a tenth of the length, all to different sides, so that a heap forms rather than a stack.
std::vector<Rod> build_rods(const FallingRods& p) {
  std::vector<Rod> rods;
  for (int k = 0; k < p.rods; ++k) {
    const double angle = k * p.turn_deg * pi / 180, side = k * golden_turn;
    const Vector3 half = p.length_m / 2 * Vector3(std::cos(angle), 0, std::sin(angle));
    const Vector3 centre(p.length_m / 10 * std::cos(side), p.radius_m + (k + 1) * p.height_m,
                         p.length_m / 10 * std::sin(side));
    const std::vector<SegmentSpec> segments = segments_through(line(centre - half, centre + half, p.segments), p);
    rods.push_back(chain(segments, p, weight(segments, p)));
  }
  return rods;
}

Rod build_rod(const CoilingRod& p) {
  std::vector<Vector3> vertices;
  for (int i = 0; i <= p.segments; ++i) {
    const double along = static_cast<double>(i) / p.segments, turn = 2 * pi * along / 100;
    vertices.emplace_back(p.radius_m * (std::cos(turn) - 1), p.height_m + p.radius_m + p.length_m * (1 - along),
                          p.radius_m * std::sin(turn));
  }
  std::vector<SegmentSpec> segments = segments_through(vertices, p);
  segments.front().is_static = true;
  return chain(segments, p, weight(segments, p), true);
}

std::vector<Rod> build_rods(const RingChain& p) {
  Ring ring;
  static_cast<RodParameters&>(ring) = p;
  ring.segments = p.segments;
  ring.length_m = p.length_m;
  ring.rest_shape = Ring::RestShape::circle;
  // From the top of a ring to that of the next: the inner diameter less the next one's own thickness. Twice the
  // apothem, since rings hang from the middle of a side; a tenth of a radius is left free.
  const double drop = p.length_m / p.segments / std::tan(pi / p.segments) - 2.1 * p.radius_m;
  std::vector<Rod> rods;
  for (int k = 0; k < p.rings; ++k) {
    ring.clamp = k == 0 ? Clamp::segment : Clamp::free;
    const Quaternion turn(Eigen::AngleAxisd(k % 2 * pi / 2, Vector3::UnitY()));
    rods.push_back(moved(build_rod(ring), turn, Vector3(0, -k * drop, 0)));
  }
  return rods;
}

std::vector<Rod> build_rods(const Bundle& p) {
  const std::vector<Vector3> places = hexagonal_places(p.rods);
  const double widest = std::max(1.0, places.back().norm());
  std::vector<Rod> rods;
  for (const Vector3& place : places) {
    const double angle = p.initial_angle_deg * pi / 180 * place.norm() / widest;
    const Vector3 outwards = place.isZero() ? Vector3(0, 0, 0) : Vector3(place.normalized());
    const Vector3 top = 2.1 * p.radius_m * place;
    const Vector3 along = std::sin(angle) * outwards - std::cos(angle) * Vector3::UnitY();
    std::vector<SegmentSpec> segments = segments_through(line(top, top + p.length_m * along, p.segments), p);
    segments.front().is_static = true;
    rods.push_back(chain(segments, p, weight(segments, p)));
  }
  return rods;
}

}  // namespace rodsweep
