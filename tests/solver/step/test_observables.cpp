// Observables against closed forms.
#include <cmath>
#include <limits>

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_observables {

using test::move_rigidly, test::Random, test::set_rigid_velocity;

/// A straight rod along +x, of length 2.
Rod straight(int segments, Clamp clamp) {
  BendingRod spec = test::bending_rod(segments, clamp);
  spec.initial_angle_deg = 0;
  return build_scene(spec).rods.front();
}

/// A free rod bent into an arc: every joint is closed and turned by `angle` about the same local axis.
Rod bent(int segments, double angle) {
  Rod rod = straight(segments, Clamp::free);
  for (int s = 1; s < segments; ++s) {
    const Joint& joint = rod.joints[s - 1];
    rod.orientation[s] = rod.orientation[s - 1] * Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitX()));
    rod.position[s] = rod.position[s - 1] + rod.orientation[s - 1] * joint.arm_a - rod.orientation[s] * joint.arm_b;
  }
  return rod;
}

TEST_CASE("a straight rod is as long as it was built, under every clamp and after rigid motion") {
  Random random(1);
  for (const Clamp clamp : {Clamp::segment, Clamp::wall, Clamp::free})
    for (const int segments : {2, 7}) {
      Rod rod = straight(segments, clamp);
      CHECK(rod_length(rod) == Approx(2).epsilon(1e-14));
      move_rigidly(rod, random.quaternion(), random.vector(5));
      CHECK(rod_length(rod) == Approx(2).epsilon(1e-14));
    }
  CHECK(rod_length(straight(1, Clamp::free)) == Approx(2).epsilon(1e-14));
}

TEST_CASE("a stretched rod is longer by its gaps, the largest is the joint gap; bending changes neither") {
  Rod rod = straight(4, Clamp::free);
  for (int s = 2; s < 4; ++s) rod.position[s].x() += 0.01;
  rod.position[3].x() += 0.002;
  // Each gap counts half on both sides; all of it lies within the rod.
  CHECK(rod_length(rod) == Approx(2.012).epsilon(1e-13));
  CHECK(joint_gap(rod) == Approx(0.01 / 0.5).epsilon(1e-12));
  CHECK(joint_gap(bent(12, 1.5)) < 1e-15);
  CHECK(rod_length(bent(12, 1.5)) == Approx(2).epsilon(1e-13));
}

TEST_CASE("a joint opened sideways counts by its midpoint, the same from either end") {
  Rod rod = straight(3, Clamp::free);  // along x
  const double l = 2.0 / 3, gap = 0.3;
  rod.position[1].y() += gap;
  CHECK(rod_length(rod) == Approx(l + 2 * std::hypot(l, gap / 2)).epsilon(1e-13));
}

TEST_CASE("elastic energy of a uniformly bent rod is EI kappa^2 / 2 times the length that bends") {
  const int segments = 40;
  const double angle = 1e-3, l = 2.0 / segments, kappa = angle / l;
  const double stiffness = 1e6 * pi * std::pow(0.05, 4) / 4;  // E of bending_rod()
  const Rod rod = bent(segments, angle);
  CHECK(elastic_energy(rod) == Approx(stiffness * kappa * kappa / 2 * (2 - l)).epsilon(1e-6));
  // For any angle, the discrete law: C = 2 sin(angle / 2).
  const double c = 2 * std::sin(0.7 / 2);
  CHECK(elastic_energy(bent(segments, 0.7)) == Approx((segments - 1) * stiffness / l * c * c / 2).epsilon(1e-12));
  CHECK(elastic_energy(straight(5, Clamp::wall)) < 1e-20);
}

TEST_CASE("elastic energy of twist is GJ phi^2 / 2 l, of stretch (gap / l)^2 / 2 alpha, of inextensible joints none") {
  Rod rod = straight(2, Clamp::free);
  rod.orientation[1] = rod.orientation[1] * Quaternion(Eigen::AngleAxisd(1e-3, Vector3::UnitZ()));
  const double torsion = 1e6 * pi * std::pow(0.05, 4) / 2;
  CHECK(elastic_energy(rod) == Approx(torsion * 1e-6 / 2).epsilon(1e-6));  // l = 1
  rod = straight(2, Clamp::free);
  rod.position[1] += Vector3(3e-4, 0, 4e-4);
  const double open = 25e-8 / rod.joints[0].compliance[0] / 2;
  rod.joints[0].is_inextensible = true;
  CHECK(elastic_energy(rod) < 1e-20);
  CHECK(gap_energy(rod) == Approx(open).epsilon(1e-9));
  rod.joints[0].is_inextensible = false;
  CHECK(elastic_energy(rod) == Approx(open).epsilon(1e-9));
  CHECK(gap_energy(rod) == 0);
  rod.joints[0].compliance.head<3>().setZero();
  CHECK(elastic_energy(rod) < 1e-20);  // a rigid row stores nothing
}

TEST_CASE("a rod that flies and turns rigidly has the energy and momenta of one long cylinder") {
  const double mass = 1000 * pi * 0.05 * 0.05 * 2, r2 = 0.05 * 0.05;
  const double transverse = mass * (3 * r2 + 4) / 12, axial = mass * r2 / 2;
  Rod rod = straight(6, Clamp::free);
  const Vector3 centre(1, 0, 0), v(1, 2, 3), w(0.7, -1.1, 2);
  const Vector3 spin(axial * w.x(), transverse * w.y(), transverse * w.z()), momentum = mass * v;
  set_rigid_velocity(rod, v - w.cross(centre), w);
  CHECK((linear_momentum(rod) - momentum).norm() < 1e-12);
  CHECK((angular_momentum(rod) - spin - centre.cross(momentum)).norm() < 1e-12 * momentum.norm());
  CHECK(kinetic_energy(rod) == Approx(w.dot(spin) / 2 + mass * v.squaredNorm() / 2).epsilon(1e-13));
}

TEST_CASE("static segments have no energy and no momentum") {
  Rod rod = straight(4, Clamp::segment);
  set_rigid_velocity(rod, {1, 0, 0}, Vector3::Zero());
  const double free_mass = 1000 * pi * 0.05 * 0.05 * 1.5;
  CHECK(linear_momentum(rod).x() == Approx(free_mass).epsilon(1e-13));
  CHECK(kinetic_energy(rod) == Approx(free_mass / 2).epsilon(1e-13));
  CHECK(gravitational_energy(rod, {-2, 0, 0}) == Approx(free_mass * 2 * 1.25).epsilon(1e-13));
}

TEST_CASE("a state with a NaN or infinity anywhere is not finite") {
  const Rod good = straight(3, Clamp::segment);
  CHECK(is_finite(good));
  for (int s = 0; s < 3; ++s)
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      Rod rod = good;
      rod.position[s].z() = bad;
      CHECK_FALSE(is_finite(rod));
      rod = good;
      rod.orientation[s].w() = bad;
      CHECK_FALSE(is_finite(rod));
    }
}

}  // namespace rodsweep::test_observables
