// The response of rods to impulses, against dense algebra and rigid bodies; Delassus operators against responses.
#include <catch2/catch.hpp>

#include "solver/contact/rod_response.hpp"
#include "solver/numbers/rotation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_rod_response {

using test::MatrixX;

constexpr double dt = 0.01;

std::vector<Lane8> lanes(const VectorX& v) {
  std::vector<Lane8> out;
  for (Eigen::Index i = 0; i < v.size(); i += 6) out.push_back(load6(v.data() + i));
  return out;
}

VectorX entries(const std::vector<Lane8>& lanes) {
  VectorX out(6 * static_cast<Eigen::Index>(lanes.size()));
  for (std::size_t i = 0; i < lanes.size(); ++i) store6(out.data() + 6 * i, lanes[i]);
  return out;
}

TEST_CASE("a response is that of dense algebra, on any graph, and responses add up") {
  const std::vector<std::pair<test::Edges, std::vector<int>>> graphs{
      {test::chain(12), {}}, {test::chain(9), {0, 8}}, {test::tree(3, 3), {0}}, {test::ring(9), {}}};
  for (const auto& [edges, held] : graphs) {
    const Rod rod = test::random_rod(edges, held, 1);
    const test::DenseSystem dense = test::dense_system(rod, dt);
    RodResponse response(rod);
    response.assemble(rod, dt);
    VectorX multipliers = VectorX::Zero(6 * rod.joint_count());
    for (const unsigned seed : {2U, 3U}) {
      const VectorX motion = dense.inverse_mass * test::Random(seed).entries(6 * rod.segment_count());
      const VectorX back = -test::dense_solve(dense.a, dense.jacobian * motion);
      const VectorX expected = motion + dense.inverse_mass * dense.jacobian.transpose() * back;
      multipliers += back;
      std::vector<Lane8> moved = lanes(motion);
      response.respond(rod, moved.data());
      CHECK((entries(moved) - expected).norm() < 1e-7 * motion.norm());  // the dense Jacobian is a finite difference
      CHECK((response.multipliers() - multipliers).norm() < 1e-6 * multipliers.norm());
    }
  }
}

TEST_CASE("a stiff rod gives way to an impulse like a rigid body, a limp one like its segment alone") {
  BendingRod p = test::bending_rod(11, Clamp::free);
  p.density_kg_m3 = 1000;
  p.initial_angle_deg = 0;
  for (const bool stiff : {true, false}) {
    p.youngs_modulus_pa = p.torsion_modulus_pa = stiff ? 1e15 : 1e-9;
    p.stretch_compliance_per_j = stiff ? 1e-15 : 1e15;
    Rod rod = build_scene(p).rods.front();
    const Segment& segment = rod.segments.front();
    const double mass = 11 * segment.mass,
                 inertia =
                     mass * (3 * segment.radius_m * segment.radius_m + 121 * segment.length_m * segment.length_m) / 12;
    const Vector3 along = (rod.position[10] - rod.position[0]).normalized(), push = along.unitOrthogonal();
    std::vector<Lane8> motion(11, Lane8{});
    for (int c = 0; c < 3; ++c) motion[0][c] = push[c] * segment.inverse_mass;
    RodResponse response(rod);
    response.assemble(rod, dt);
    response.respond(rod, motion.data());
    const double arm = (rod.position[5] - rod.position[0]).norm();
    Vector3 momentum = Vector3::Zero();
    for (const Lane8& moved : motion) momentum += segment.mass * Vector3(moved[0], moved[1], moved[2]);
    CHECK((momentum - push).norm() < 1e-6);
    const double moved = Vector3(motion[0][0], motion[0][1], motion[0][2]).dot(push);
    CHECK(moved == Approx(stiff ? 1 / mass + arm * arm / inertia : segment.inverse_mass).epsilon(1e-5));
  }
}

/// The motion of all segments by a force and a torque on one.
std::vector<Lane8> responded(const Rod& rod, RodResponse& response, int segment, const Lane8& wrench) {
  std::vector<Lane8> motion(rod.segments.size(), Lane8{});
  motion[static_cast<std::size_t>(segment)] = response.free_motion(rod, segment, wrench);
  response.respond(rod, motion.data());
  return motion;
}

TEST_CASE("a Delassus operator moves the touched segments as the whole rod responds, condensed or not") {
  std::vector<Rod> rods{test::random_rod(test::chain(12), {0}, 1), test::random_rod(test::tree(3, 3), {0}, 1),
                        test::random_rod(test::ring(9), {}, 1)};
  for (const Lattice::Cell cell : {Lattice::Cell::octet, Lattice::Cell::body_centred})
    rods.push_back(build_scene(test::lattice_of(cell, 3)).rods.front());
  Net net;
  net.rows = net.columns = 6;
  rods.push_back(build_scene(net).rods.front());
  for (const Rod& rod : rods) {
    RodResponse response(rod);
    response.assemble(rod, dt);
    DelassusOperator delassus(rod.segment_count(), 40);
    std::vector<int> touched;
    const auto touch = [&](int segment) {
      if (rod.segments[static_cast<std::size_t>(segment)].is_static) return;
      touched.push_back(segment);
      delassus.touch(segment);
    };
    const int last = rod.segment_count() - 1;
    for (const int segment : {last, last / 2, last / 2 + 1}) touch(segment);
    delassus.update(rod, response);
    for (const int segment : {1, last / 3, last - 1}) touch(segment);
    delassus.update(rod, response);
    REQUIRE_FALSE(delassus.is_full());
    for (const int by : touched)
      for (int c = 0; c < 6; ++c) {
        const std::vector<Lane8> expected = responded(rod, response, by, unit_lane[c]);
        double scale = 0, error = 0;
        for (const int of : touched)
          for (int r = 0; r < 6; ++r) {
            const Lane8& motion = expected[static_cast<std::size_t>(of)];
            scale = std::max(scale, std::abs(motion[r]));
            error = std::max(error, std::abs(delassus.block(of, by).column[c][r] - motion[r]));
          }
        CHECK(error / scale < 1e-7);
      }
    delassus.clear();
    delassus.touch(1);
    delassus.update(rod, response);
    const std::vector<Lane8> expected = responded(rod, response, 1, unit_lane[1]);
    CHECK(delassus.block(1, 1).column[1][1] == Approx(expected[1][1]));
  }
}

TEST_CASE("a Delassus operator refuses one segment too many") {
  const Rod rod = test::random_rod(test::chain(12), {}, 1);
  RodResponse response(rod);
  response.assemble(rod, dt);
  DelassusOperator delassus(rod.segment_count(), 2);
  for (const int segment : {3, 5, 3}) delassus.touch(segment);
  CHECK_FALSE(delassus.is_full());
  delassus.touch(4);
  CHECK(delassus.is_full());
  delassus.clear();
  CHECK_FALSE(delassus.is_full());
}

TEST_CASE("a response is rough once a segment has turned, not if the rod has moved") {
  Rod rod = test::random_rod(test::chain(6), {}, 1);
  RodResponse response(rod);
  response.assemble(rod, dt);
  for (Vector3& position : rod.position) position += Vector3(1, 2, 3);
  CHECK_FALSE(response.is_stale(rod));
  rod.orientation[4] = rotated(rod.orientation[4], Vector3(0, 0.09, 0));
  CHECK_FALSE(response.is_stale(rod));
  rod.orientation[4] = rotated(rod.orientation[4], Vector3(0, 0.02, 0));
  CHECK(response.is_stale(rod));
}

}  // namespace rodsweep::test_rod_response
