// Constraints and Jacobians against central differences. tests/solver/step/test_turned_scenes.cpp turns whole systems.
#include <cmath>
#include <limits>

#include "solver/linear/linear_system.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_linearization {

using test::MatrixX;

/// J of one joint as linearize() gives it, 6 x 12: u_a, phi_a, u_b, phi_b.
MatrixX jacobian_of(const JointJacobian& j) {
  MatrixX out = MatrixX::Zero(6, 12);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      out(r, c) = j.shift_a[c][r];
      out(r, 6 + c) = j.shift_b[c][r];
    }
    for (int r = 0; r < 6; ++r) {
      out(r, 3 + c) = j.rotation_a[c][r];
      out(r, 9 + c) = j.rotation_b[c][r];
    }
  }
  return out;
}

/// The same for motions in the world: dx_a, dtheta_a, dx_b, dtheta_b.
MatrixX world_jacobian(const Rod& rod, int joint, const JointJacobian& j) {
  MatrixX out = jacobian_of(j);
  const int segments[] = {rod.joints[joint].a, rod.joints[joint].b};
  for (int half = 0; half < 4; ++half)
    out.middleCols(3 * half, 3) *= rod.orientation[segments[half / 2]].toRotationMatrix().transpose();
  return out;
}

Linearization linearized(const Rod& rod) {
  Linearization out(rod);
  linearize(rod, out);
  return out;
}

TEST_CASE("constraints are the joint gap and the Darboux vector's change, both dimensionless") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Rod rod = test::random_rod(test::chain(6), {0}, seed);
    CHECK((linearized(rod).constraint - test::constraint(rod)).lpNorm<Eigen::Infinity>() < 1e-13);
  }
}

TEST_CASE("turned by its joint's frame into the world, stretch-shear is the gap over the joint's length") {
  const Rod rod = test::random_rod(test::net(3, 3), {0}, 4);
  const VectorX c = linearized(rod).constraint;
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& j = rod.joints[k];
    const Vector3 gap =
        rod.position[j.a] + rod.orientation[j.a] * j.arm_a - rod.position[j.b] - rod.orientation[j.b] * j.arm_b;
    CHECK((to_world(rod, j, c.segment<3>(6 * k)) - gap / j.length).norm() < 1e-13);
  }
}

TEST_CASE("Jacobians equal central differences of the constraints under the Newton update") {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Rod rod = test::random_rod({{0, 1}}, {}, seed);
    const MatrixX expected = test::dense_system(rod, 0.01).jacobian;
    CHECK((world_jacobian(rod, 0, linearized(rod).joints[0]) - expected).cwiseAbs().maxCoeff() < 1e-8);
  }
}

TEST_CASE("bending by more than half a turn of the rest rotation is measured the short way round") {
  // Relative turns of 2 pi - 0.2 and -0.2 are the same pose and must give the same small constraint.
  Rod rod = build_scene(test::bending_rod(2, Clamp::free)).rods.front();
  rod.orientation[1] = rod.orientation[0] * Eigen::AngleAxisd(2 * pi - 0.2, Vector3::UnitX());
  const VectorX c = linearized(rod).constraint;
  CHECK(c[3] == Approx(-2 * std::sin(0.1)).epsilon(1e-12));
  CHECK(std::abs(c[4]) < 1e-15);
}

TEST_CASE("a joint whose segments change places has the same frame: its constraint and Jacobian change their sign") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Rod rod = test::random_rod({{0, 1}}, {}, seed);
    Rod exchanged = rod;
    Joint& joint = exchanged.joints[0];
    std::swap(joint.a, joint.b);
    std::swap(joint.arm_a, joint.arm_b);
    std::swap(joint.frame_a, joint.frame_b);
    const Linearization one = linearized(rod), other = linearized(exchanged);
    CHECK((one.constraint + other.constraint).lpNorm<Eigen::Infinity>() < 1e-13);
    MatrixX expected(6, 12);
    expected << -jacobian_of(one.joints[0]).rightCols(6), -jacobian_of(one.joints[0]).leftCols(6);
    CHECK((jacobian_of(other.joints[0]) - expected).norm() < 1e-13 * expected.norm());
  }
}

TEST_CASE("the Newton residual is the largest |C + alpha~ lambda|") {
  const double dt = 0.01;
  const Rod rod = test::random_rod(test::tree(2, 2), {0}, 5);
  const double expected = test::dense_system(rod, dt).b.lpNorm<Eigen::Infinity>();
  CHECK(test::assembled(rod, dt).newton_residual() == Approx(expected).epsilon(1e-13));
  CHECK(newton_residual(rod, dt) == Approx(expected).epsilon(1e-13));
}

TEST_CASE("a NaN or infinity anywhere in the state makes the Newton residual NaN") {
  const double bad = GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
  for (int s = 0; s < 6; ++s)
    for (const bool in_orientation : {false, true}) {
      Rod rod = test::random_rod(test::chain(6), {}, 9);
      (in_orientation ? rod.orientation[s].x() : rod.position[s].y()) = bad;
      CHECK(std::isnan(test::assembled(rod, 0.01).newton_residual()));
      CHECK(std::isnan(newton_residual(rod, 0.01)));
    }
}

TEST_CASE("a single segment has nothing to satisfy") {
  const Rod rod = build_scene(test::bending_rod(1, Clamp::free)).rods.front();
  CHECK(test::assembled(rod, 0.01).newton_residual() == 0);
  CHECK(newton_residual(rod, 0.01) == 0);
}

}  // namespace rodsweep::test_linearization
