// Rings and nets: geometry, rest states, held segments, counts, length, refusals.
#include <cmath>
#include <map>

#include "solver/linear/linear_system.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_closed_scenes {

using test::constraint_of;

Ring ring(int segments, double twist_deg = 0, Ring::RestShape shape = Ring::RestShape::straight) {
  Ring p;
  p.segments = segments;
  p.length_m = 3;
  p.twist_deg = twist_deg;
  p.rest_shape = shape;
  return p;
}

int held_segments(const Rod& rod) {
  int held = 0;
  for (const Segment& s : rod.segments) held += s.is_static;
  return held;
}

TEST_CASE("a ring is a closed regular polygon below its first segment, whose middle is the origin") {
  const Rod rod = build_scene(ring(12)).rods.front();
  REQUIRE(rod.segment_count() == 12);
  REQUIRE(rod.joint_count() == 12);
  CHECK(rod.position[0].norm() < 1e-15);
  CHECK((director(rod.orientation[0]) - Vector3::UnitX()).norm() < 1e-15);
  CHECK(rod_length(rod) == Approx(3).epsilon(1e-13));
  CHECK(joint_gap(rod) < 1e-14);
  const double apothem = 3.0 / 12 / 2 / std::tan(pi / 12);
  for (int s = 0; s < 12; ++s) {
    CHECK((rod.position[s] - Vector3(0, -apothem, 0)).norm() == Approx(apothem).epsilon(1e-13));
    CHECK(std::abs(rod.position[s].z()) < 1e-15);
    CHECK(rod.segments[s].is_static == (s == 0));
  }
  Ring free = ring(12);
  free.clamp = Clamp::free;
  CHECK(held_segments(build_scene(free).rods.front()) == 0);
}

TEST_CASE("a ring that is naturally circular starts unstrained, a straight one is bent alike in every joint") {
  CHECK(constraint_of(build_scene(ring(20, 0, Ring::RestShape::circle)).rods.front()).norm() < 1e-13);
  const VectorX bent = constraint_of(build_scene(ring(20)).rods.front());
  for (int k = 0; k < 20; ++k) {
    CHECK(bent.segment<3>(6 * k).norm() < 1e-13);
    CHECK(bent.segment<3>(6 * k + 3).head<2>().norm() == Approx(2 * std::sin(pi / 20)).epsilon(1e-12));
    CHECK(std::abs(bent[6 * k + 5]) < 1e-13);
  }
}

TEST_CASE("the twist of a ring is spread evenly, also over the joint that closes it, for any angle") {
  for (const double twist : {90.0, 360.0, 1000.0, -500.0})
    for (const auto shape : {Ring::RestShape::straight, Ring::RestShape::circle}) {
      const int n = 40;
      const Rod rod = build_scene(ring(n, twist, shape)).rods.front();
      const VectorX c = constraint_of(rod);
      const double per_joint = twist * pi / 180 / n;
      for (int k = 0; k < n; ++k) {
        // 2 sin(phi / 2) cos(theta / 2): the joint is twisted by phi and bent by theta.
        const double twisted = 2 * std::sin(per_joint / 2) * std::cos(pi / n);
        if (shape == Ring::RestShape::straight) {
          CHECK(c[6 * k + 5] == Approx(twisted).epsilon(1e-10));
          CHECK(c.segment<6>(6 * k).norm() == Approx(c.segment<6>(0).norm()).epsilon(1e-10));
        } else {  // the curved rest shape turns with the twist, against the ring's
          CHECK(c[6 * k + 5] == Approx(twisted).epsilon(1e-2));
        }
        CHECK(rod.joints[k].rest().w() > 0.5);
      }
    }
}

TEST_CASE("a net's rods cross where they should, and half a segment stands out on every side") {
  Net p;
  p.rows = 3;
  p.columns = 4;
  p.segments = 2;
  p.mesh_m = 0.5;
  p.held = Held::free;
  const Rod rod = build_scene(p).rods.front();
  CHECK(rod.segment_count() == 3 * 7 + 4 * 5);
  CHECK(rod.joint_count() == 3 * 6 + 4 * 4 + 12);
  CHECK(rod_length(rod) == Approx(0.25 * rod.segment_count()).epsilon(1e-13));
  CHECK(constraint_of(rod).norm() < 1e-13);
  int crossings = 0;
  for (const Joint& joint : rod.joints) {
    if (!joint.arm_a.isZero()) continue;
    const Vector3 at = rod.position[joint.a];
    CHECK((at - rod.position[joint.b]).norm() < 1e-14);
    CHECK((at - Vector3(crossings % 4 * 0.5, 0, crossings / 4 * 0.5)).norm() < 1e-14);
    CHECK(std::abs(director(rod.orientation[joint.a]).dot(director(rod.orientation[joint.b]))) < 1e-14);
    ++crossings;
  }
  CHECK(crossings == 12);
}

TEST_CASE("a crossing turns against EI / l about every axis") {
  Net p;
  p.held = Held::free;
  const Rod start = build_scene(p).rods.front();
  const double angle = 1e-4, stiffness = 1e5 * pi * std::pow(0.05, 4) / 4 / p.mesh_m;
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(1, -2, 2)}) {
    Rod rod = start;
    rod.joints.assign(1, start.joints.back());
    rod.lambda = VectorX::Zero(6);
    Quaternion& q = rod.orientation[rod.joints[0].b];
    q = Quaternion(Eigen::AngleAxisd(angle, axis.normalized())) * q;
    CHECK(elastic_energy(rod) == Approx(stiffness * angle * angle / 2).epsilon(1e-3));
  }
}

TEST_CASE("a net is held at a side, at its corners, or not at all") {
  Net p;
  p.rows = 3;
  p.columns = 4;
  for (const auto& [held, count] : std::map<Held, int>{{Held::side, 4}, {Held::corners, 4}, {Held::free, 0}}) {
    p.held = held;
    const Rod rod = build_scene(p).rods.front();
    CHECK(held_segments(rod) == count);
    CHECK(constraint_of(rod).norm() < 1e-13);
    double far = 0;
    for (int s = 0; s < rod.segment_count(); ++s)
      if (rod.segments[s].is_static) far = std::max(far, rod.position[s].z());
    CHECK(far == Approx(held == Held::corners ? 2 * p.mesh_m : 0).margin(1e-14));
    CHECK_NOTHROW(LinearSystem(rod));  // no joint connects two held segments
  }
}

TEST_CASE("a held crossing is a point that clamps half a segment of every rod through it") {
  Net p;
  p.rows = p.columns = 3;
  p.mesh_m = 0.4;
  p.held = Held::side;
  const Rod rod = build_scene(p).rods.front();
  std::vector<int> joints_at(static_cast<std::size_t>(rod.segment_count()));
  for (const Joint& joint : rod.joints) {
    const int held = rod.segments[joint.a].is_static ? joint.a : joint.b;
    if (!rod.segments[held].is_static) continue;
    ++joints_at[static_cast<std::size_t>(held)];
    const int free = joint.a + joint.b - held;
    CHECK(rod.segments[held].length_m == 0);
    CHECK(rod.segments[free].length_m == Approx(0.2));
    CHECK((rod.position[free] - rod.position[held]).norm() == Approx(0.1));
    const Quaternion frame = rod.orientation[joint.a] * joint.frame_a;
    CHECK((frame.coeffs() - rod.orientation[free].coeffs()).norm() < 1e-14);
    CHECK(joint.length == Approx(0.1));
  }
  std::sort(joints_at.rbegin(), joints_at.rend());
  CHECK(std::vector<int>(joints_at.begin(), joints_at.begin() + 4) == std::vector<int>{3, 2, 2, 0});
}

TEST_CASE("stretching the rods of a net makes it longer, a joint opened at a crossing does not") {
  Net p;
  p.held = Held::free;
  Rod rod = build_scene(p).rods.front();
  const double length = rod_length(rod);
  for (int s = 5 * 5; s < rod.segment_count(); ++s) rod.position[s].y() += 0.1;  // the rods along z
  CHECK(rod_length(rod) == Approx(length).epsilon(1e-13));
  CHECK(joint_gap(rod) == Approx(0.1 / p.mesh_m).epsilon(1e-12));
  for (int s = 0; s < 5; ++s) rod.position[s].x() *= 1.01;  // the first rod along x
  CHECK(rod_length(rod) == Approx(length + 4 * 0.01 * p.mesh_m).epsilon(1e-12));
}

TEST_CASE("rings and nets that cannot be are refused by what is wrong with them") {
  CHECK_THROWS_WITH(build_scene(ring(2)), "segments is 2; must be at least 3: fewer do not close a ring");
  Ring wall = ring(9);
  wall.clamp = Clamp::wall;
  CHECK_THROWS_WITH(build_scene(wall), "a ring has no end that the clamp \"wall\" could hold");
  CHECK_THROWS_WITH(build_scene(ring(4, 361)),
                    Catch::Matchers::StartsWith("twist_deg is 361.000000; must be at most 90"));
  Net net;
  net.rows = 1;
  CHECK_THROWS_WITH(build_scene(net), "rows is 1; must be at least 2");
  net.rows = net.columns = 1000;
  net.segments = 1000;
  CHECK_THROWS_WITH(validate(net), Catch::Matchers::StartsWith("a net ") && Catch::Matchers::EndsWith(" 10000000"));
  BendingRod both = test::bending_rod(4);
  both.stretch = Stretch::physical;
  both.stretch_compliance_per_j = 1e-6;
  CHECK_THROWS_WITH(validate(both), Catch::Matchers::ContainsSubstring("stretch is physical") &&
                                        Catch::Matchers::ContainsSubstring("stretch_compliance_per_j"));
}

}  // namespace rodsweep::test_closed_scenes
