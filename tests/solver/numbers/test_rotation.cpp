// The two rotation maps of the time step, and the rotation between two directions.
#include <cmath>

#include "solver/numbers/rotation.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_rotation {

using test::Random;

TEST_CASE("rotation() gives back exactly the vector that rotated() was given, small or huge") {
  Random random(1);
  for (const double size : {1e-9, 1e-3, 1.0, 100.0})
    for (int i = 0; i < 50; ++i) {
      const Quaternion q = random.quaternion();
      const Vector3 theta = size * random.vector(1);
      // Rounding of q limits the accuracy of small angles.
      CHECK((rotation(rotated(q, theta), q) - theta).norm() <= 1e-15 + 1e-13 * theta.norm() * (1 + theta.norm()));
    }
}

TEST_CASE("rotation() does not depend on the sign of either quaternion") {
  Random random(2);
  const Quaternion old = random.quaternion();
  const Vector3 theta(0.3, -0.2, 0.1);
  Quaternion q = rotated(old, theta), minus_old = old;
  q.coeffs() *= -1;
  CHECK((rotation(q, old) - theta).norm() < 1e-14);
  minus_old.coeffs() *= -1;
  CHECK((rotation(rotated(old, theta), minus_old) - theta).norm() < 1e-14);
}

TEST_CASE("rotated() turns by 2 atan(|theta| / 2) about theta in the world frame") {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Quaternion q = random.quaternion();
    const Vector3 theta = random.vector(2), v = random.vector(1);
    const Eigen::AngleAxisd turn(2 * std::atan(theta.norm() / 2), theta.normalized());
    CHECK((rotated(q, theta) * v - turn * (q * v)).norm() < 1e-14);
  }
}

TEST_CASE("rotated() by nothing changes nothing, and a thousand updates leave a unit quaternion") {
  Random random(4);
  Quaternion q = random.quaternion();
  CHECK((rotated(q, Vector3::Zero()).coeffs() - q.coeffs()).norm() < 3e-16);
  for (int i = 0; i < 1000; ++i) q = rotated(q, random.vector(0.5));
  CHECK(std::abs(q.norm() - 1) < 5e-16);
}

TEST_CASE("turn_between() takes one direction to the other by the shortest way, opposite ones too") {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Vector3 from = random.vector(3), to = i % 5 == 0 ? Vector3(-2 * from) : random.vector(3);
    const Quaternion turn = turn_between(from, to);
    CHECK(turn.norm() == Approx(1).epsilon(1e-14));
    CHECK((turn * from.normalized() - to.normalized()).norm() < 1e-12);
    CHECK(std::abs(turn.vec().dot(from)) < 1e-12 * from.norm());  // the axis is perpendicular to both
    CHECK(turn.w() >= 0);
  }
}

}  // namespace rodsweep::test_rotation
