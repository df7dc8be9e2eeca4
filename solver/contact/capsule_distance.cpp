#include "solver/contact/capsule_distance.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

double clamp(double s) { return std::clamp(s, -1.0, 1.0); }

}  // namespace

AxisPoints closest_points(const CapsuleAxis& a, const CapsuleAxis& b) {
  constexpr double parallel = 1e-12;  // squared sine of the angle of parallel axes
  const Vector3 c = a.centre - b.centre;
  const double uu = a.half.squaredNorm(), uv = a.half.dot(b.half), vv = b.half.squaredNorm();
  const double uc = a.half.dot(c), vc = b.half.dot(c);
  const double determinant = uu * vv - uv * uv;
  double s = 0;
  if (determinant > parallel * uu * vv) {
    s = clamp((uv * vc - vv * uc) / determinant);
  } else if (uu > 0) {
    const Overlap both = overlap(a, b);
    s = clamp((both.low + both.high) / 2);
  }
  const double t = vv > 0 ? clamp((uv * s + vc) / vv) : 0;
  return {uu > 0 ? clamp((uv * t - uc) / uu) : 0, t};
}

double closest_point(const CapsuleAxis& axis, const Vector3& point) {
  const double square = axis.half.squaredNorm();
  return square > 0 ? clamp(axis.half.dot(point - axis.centre) / square) : 0;
}

Vector3 separation(const CapsuleAxis& a, const CapsuleAxis& b) {
  const AxisPoints at = closest_points(a, b);
  return a.at(at.s) - b.at(at.t);
}

Overlap overlap(const CapsuleAxis& a, const CapsuleAxis& b) {
  const double square = a.half.squaredNorm();
  if (!(square > 0)) return {0, 0};
  const double middle = a.half.dot(b.centre - a.centre) / square, reach = std::abs(a.half.dot(b.half)) / square;
  return {std::max(-1.0, middle - reach), std::min(1.0, middle + reach)};
}

double relative_motion(const CapsuleAxis& a_from, const CapsuleAxis& a_to, const CapsuleAxis& b_from,
                       const CapsuleAxis& b_to) {
  return ((a_to.centre - a_from.centre) - (b_to.centre - b_from.centre)).norm() + (a_to.half - a_from.half).norm() +
         (b_to.half - b_from.half).norm();
}

CapsuleAxis between(const CapsuleAxis& from, const CapsuleAxis& to, double time) {
  return {from.centre + time * (to.centre - from.centre), from.half + time * (to.half - from.half)};
}

std::optional<double> first_touch(const CapsuleAxis& a_from, const CapsuleAxis& a_to, const CapsuleAxis& b_from,
                                  const CapsuleAxis& b_to, double distance) {
  const double speed = relative_motion(a_from, a_to, b_from, b_to);
  double time = 0;
  for (int advance = 0; advance < 64; ++advance) {
    const double beyond = separation(between(a_from, a_to, time), between(b_from, b_to, time)).norm() - distance;
    if (beyond <= 1e-3 * distance) return time;
    if (!(beyond < speed * (1 - time))) return std::nullopt;
    time += beyond / speed;
  }
  return time;
}

}  // namespace rodsweep
