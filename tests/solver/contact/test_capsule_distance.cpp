// Closest points of axes against brute force, first contacts against closed forms.
#include <algorithm>
#include <cmath>

#include "solver/contact/capsule_distance.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_capsule_distance {

/// The smallest distance over a fine grid on one axis, exact along the other.
double searched_distance(const CapsuleAxis& a, const CapsuleAxis& b) {
  double least = HUGE_VAL;
  for (int i = -4000; i <= 4000; ++i) {
    const Vector3 on_a = a.at(i / 4000.0);
    const double square = b.half.squaredNorm();
    const double t = square > 0 ? std::clamp((on_a - b.centre).dot(b.half) / square, -1.0, 1.0) : 0;
    least = std::min(least, (on_a - b.at(t)).norm());
  }
  return least;
}

CapsuleAxis random_axis(test::Random& random) { return {random.vector(1), random.vector(0.7)}; }

void check_closest(const CapsuleAxis& a, const CapsuleAxis& b) {
  const AxisPoints at = closest_points(a, b);
  CHECK(std::max(std::abs(at.s), std::abs(at.t)) <= 1);
  const double found = (a.at(at.s) - b.at(at.t)).norm(), searched = searched_distance(a, b);
  CHECK(found <= searched + 1e-6);  // nearly parallel axes differ by 1e-7
  CHECK(found >= searched - 5e-4);  // resolution of the grid
  CHECK(separation(b, a).norm() == Approx(found).margin(1e-12));
}

TEST_CASE("closest points of axes are as near as any, however they lie") {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) check_closest(random_axis(random), random_axis(random));
  for (int i = 0; i < 20; ++i) {
    const CapsuleAxis a = random_axis(random);
    check_closest(a, {a.centre + random.vector(1), random.uniform(-2, 2) * a.half});          // parallel
    check_closest(a, {a.centre + random.vector(1), a.half + 1e-7 * random.vector(1)});        // nearly
    check_closest(a, {a.centre + random.uniform(-3, 3) * a.half, a.half});                    // in one line
    check_closest(a, {random.vector(1), Vector3::Zero()});                                    // axis and point
    check_closest({random.vector(1), Vector3::Zero()}, {random.vector(1), Vector3::Zero()});  // two points
    check_closest(a, {a.at(random.uniform(-1, 1)), random.vector(1)});                        // intersecting
  }
}

TEST_CASE("parallel axes are closest in the middle of their overlap") {
  const CapsuleAxis a{{0, 0, 0}, {2, 0, 0}}, b{{3, 1, 0}, {-2, 0, 0}};
  const Overlap both = overlap(a, b);
  CHECK(both.low == Approx(0.5));
  CHECK(both.high == Approx(1));
  CHECK(closest_points(a, b).s == Approx(0.75));
  const Overlap none = overlap(a, {{9, 1, 0}, {2, 0, 0}});
  CHECK(none.low > none.high);
}

TEST_CASE("axes that fly at each other first touch when they have come as near as asked") {
  const CapsuleAxis a{{0, 0, 0}, {1, 0, 0}}, from{{0, 3, 0}, {0, 0, 1}}, to{{0, -3, 0}, {0, 0, 1}};
  const auto touch = first_touch(a, a, from, to, 0.6);
  REQUIRE(touch);
  CHECK(*touch == Approx((3 - 0.6) / 6).epsilon(1e-3));
  CHECK(separation(a, between(from, to, *touch)).norm() == Approx(0.6).epsilon(2e-3));
  CHECK_FALSE(first_touch(a, a, from, {{0, 1, 0}, {0, 0, 1}}, 0.6));
  CHECK_FALSE(first_touch(a, a, {{3, 3, 0}, {0, 0, 1}}, {{3, -3, 0}, {0, 0, 1}}, 0.6));  // past the end of the axis
  CHECK(*first_touch(a, a, {{0, 0.1, 0}, {0, 0, 1}}, to, 0.6) == 0);
}

TEST_CASE("a first touch is never later than a finely sampled one") {
  test::Random random(2);
  int touches = 0;
  for (int i = 0; i < 200; ++i) {
    const CapsuleAxis a0 = random_axis(random), a1 = random_axis(random), b0 = random_axis(random),
                      b1 = random_axis(random);
    double sampled = HUGE_VAL;
    for (int k = 1000; k >= 0; --k)
      if (separation(between(a0, a1, k / 1000.0), between(b0, b1, k / 1000.0)).norm() < 0.2) sampled = k / 1000.0;
    const auto touch = first_touch(a0, a1, b0, b1, 0.2);
    if (sampled > 1) continue;
    ++touches;
    REQUIRE(touch);
    CHECK(*touch <= sampled + 1e-12);
  }
  CHECK(touches > 20);
}

}  // namespace rodsweep::test_capsule_distance
