// The law of one contact: the fixed point of the relaxation, for any effective mass.
#include <Eigen/Geometry>

#include "solver/contact/coulomb_contact.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_coulomb_contact {

/// A symmetric positive definite matrix with these eigenvalues and random axes.
Matrix3 mobility(test::Random& random, const Vector3& stretches) {
  const Matrix3 turn = random.quaternion().toRotationMatrix();
  return turn * stretches.asDiagonal() * turn.transpose();
}

TEST_CASE("relaxations of one contact settle on the law") {
  test::Random random(1);
  int open = 0, sticks = 0, slides = 0;
  for (int i = 0; i < 400; ++i) {
    const Vector3 approach = random.vector(1);
    const Matrix3 w = mobility(random, {1, random.uniform(1, 2), random.uniform(1, 3)});
    const double friction = random.uniform(0, 2);
    const CoulombContact law(w, friction);
    Vector3 impulse = Vector3::Zero(), moved = approach;
    for (int k = 0; k < 2000; ++k) {
      impulse = law.relaxed(impulse, moved);
      moved = approach + w * impulse;
    }
    const double pressed = impulse.x(), gap = moved.x();
    const Vector3 slip(0, moved.y(), moved.z()), grip(0, impulse.y(), impulse.z());
    INFO("pressed by " << pressed << ", gap " << gap << ", slip " << slip.norm() << ", grip " << grip.norm());
    CHECK(pressed >= 0);
    CHECK(gap > -1e-9);
    CHECK(std::abs(gap * pressed) < 1e-9);
    CHECK(grip.norm() <= friction * pressed * (1 + 1e-12) + 1e-15);
    if (pressed == 0) {
      ++open;
      CHECK(grip.isZero(0));
    } else if (slip.norm() < 1e-9) {
      ++sticks;
    } else {
      ++slides;
      CHECK(grip.norm() == Approx(friction * pressed));
      CHECK(grip.normalized().dot(slip.normalized()) == Approx(-1));
    }
  }
  CHECK(open > 30);
  CHECK(sticks > 30);
  CHECK(slides > 30);
}

TEST_CASE("sliding settles also where a body gives way six times as easily to one side") {
  const CoulombContact law(Vector3(1, 1, 6).asDiagonal().toDenseMatrix(), 0.5);
  const Vector3 approach(-1, 1, 0.02);
  Vector3 impulse = Vector3::Zero(), last = impulse;
  for (int k = 0; k < 100; ++k) {
    last = impulse;
    const Vector3 moved = approach + Vector3(1, 1, 6).cwiseProduct(impulse);
    impulse = law.relaxed(impulse, moved);
  }
  CHECK((impulse - last).norm() < 1e-12);
}

TEST_CASE("what is admissible stays, what is not loses friction or all") {
  const CoulombContact law(Matrix3::Identity(), 0.5);
  CHECK(law.admissible({1, 0.3, -0.4}) == Vector3(1, 0.3, -0.4));
  CHECK((law.admissible({1, 3, -4}) - Vector3(1, 0.3, -0.4)).norm() < 1e-15);
  CHECK(law.admissible({-1, 0.1, 0}) == Vector3(0, 0, 0));
}

}  // namespace rodsweep::test_coulomb_contact
