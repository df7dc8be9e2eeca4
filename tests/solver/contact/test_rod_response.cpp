// The response of rods to impulses, against dense algebra; Delassus operators against responses.

#include "solver/contact/rod_response.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_rod_response {

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

}  // namespace rodsweep::test_rod_response
