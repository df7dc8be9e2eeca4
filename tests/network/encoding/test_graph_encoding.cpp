// Features of nodes and edges: values computed by hand, and the features that move with the rod.
#include <cmath>

#include "network/encoding/graph_encoding.hpp"
#include "solver/scene/scene_parts.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_graph_encoding {

constexpr double dt = 0.02;

struct Encoded {
  Tensor<float> nodes, edges;
};

Encoded encoded(Encoding encoding, const Rod& rod, int newton = 0) {
  const GraphEncoding encode(encoding, rod);
  const LinearSystem system = test::assembled(rod, dt);
  Encoded out{Tensor<float>(GraphEncoding::node_features(encoding), rod.segment_count()),
              Tensor<float>(GraphEncoding::edge_features(encoding), rod.joint_count())};
  encode.encode(rod, system, newton, out.nodes, out.edges);
  return out;
}

/// A rotation about x; a segment along z turns towards -y.
Quaternion about_x(double angle) { return {std::cos(angle / 2), std::sin(angle / 2), 0, 0}; }

/// Three segments of 1 m, 1 m and 2 m along +z, hung by the first and bent about x by 0.3 and -0.2. At rest the first
/// joint is straight, the second bent by 0.1. Y = 2e5 Pa, T = 3e6 Pa.
Rod bent_rod() {
  RodParameters p;
  p.youngs_modulus_pa = 2e5;
  p.torsion_modulus_pa = 3e6;
  p.stretch_compliance_per_j = 1e-6;
  std::vector<Vector3> ends{Vector3(0, 5, 0), Vector3(0, 5, 1)};
  ends.push_back(ends[1] + about_x(0.3) * Vector3(0, 0, 1));
  ends.push_back(ends[2] + about_x(0.1) * Vector3(0, 0, 2));
  std::vector<SegmentSpec> segments = segments_through(ends, p);
  segments[0].is_static = true;
  Rod rod = chain(segments, p, 0);
  set_rest(rod.joints[0], about_x(0));
  set_rest(rod.joints[1], about_x(0.1));
  rod.orientation[1].coeffs() = -rod.orientation[1].coeffs();  // the same rotation, from the other hemisphere
  return rod;
}

void check_column(const Tensor<float>& features, int column, const std::vector<double>& expected) {
  CAPTURE(column);
  REQUIRE(features.rows() == static_cast<int>(expected.size()));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CAPTURE(i);
    CHECK(features(static_cast<int>(i), column) == Approx(expected[i]).epsilon(1e-5).margin(1e-7));
  }
}

// By hand. Centres: (0, 5, .5); then the end of the first (0, 5, 1) plus half the second along (0, -sin .3, cos .3);
// then the second's end plus half of 2 m along (0, -sin .1, cos .1). Bends: l C_b = 2 sin(angle / 2).
const double y1 = 5 - 0.5 * std::sin(0.3), z1 = 1 + 0.5 * std::cos(0.3);
const double y2 = 5 - std::sin(0.3) - std::sin(0.1), z2 = 1 + std::cos(0.3) + std::cos(0.1);
const double bend0 = 2 * std::sin(0.15), bend1 = 2 * std::sin(-0.1), from_rest1 = 2 * std::sin(-0.15);

TEST_CASE("paper: the features of paper_residual without the residual, at every Newton iteration") {
  for (const int newton : {0, 1}) {
    const Encoded paper = encoded(Encoding::paper, bent_rod(), newton),
                  more = encoded(Encoding::paper_residual, bent_rod(), newton);
    CHECK(paper.nodes.rows() == 14);
    CHECK(paper.edges.rows() == 5);
    CHECK(paper.nodes == more.nodes);
    CHECK(paper.edges == more.edges.topRows(5));
  }
}

TEST_CASE("paper_residual: a bent rod of three segments, by hand") {
  const Encoded e = encoded(Encoding::paper_residual, bent_rod());
  check_column(e.nodes, 0, {0, 5, .5, 1, 0, 0, 0, .05, 1000, 1, 0, 1, 1, 0});
  check_column(e.nodes, 1, {0, y1, z1, std::cos(.15), std::sin(.15), 0, 0, .05, 1000, 1, 0.4, 0, 0, 0});
  check_column(e.nodes, 2, {0, y2, z2, std::cos(.05), std::sin(.05), 0, 0, .05, 1000, 2, 1, 0, 0, 1});
  check_column(e.edges, 0, {bend0 / 1, 0, 0, 2e5, 3e6, 0, 0, 0, 0, 0, 0});
  check_column(e.edges, 1, {bend1 / 1.5, 0, 0, 2e5, 3e6, 0, 0, 0, 0, 0, 0});
}

TEST_CASE("paper_residual: from the second Newton iteration on, edges have -C - alpha~ lambda") {
  Rod rod = bent_rod();
  rod.lambda[9] = 1e-3;
  const Encoded e = encoded(Encoding::paper_residual, rod, 1);
  const double compliance = 1.5 / (2e5 * pi * std::pow(0.05, 4) / 4) / (dt * dt);
  CHECK(e.edges.col(0).tail<6>().norm() == Approx(bend0));
  CHECK(e.edges(8, 0) == Approx(-bend0));
  CHECK(e.edges(8, 1) == Approx(-from_rest1 - compliance * 1e-3));
}

/// Rows of features in which some column differs by more than rounding.
std::vector<int> changed(const Tensor<float>& a, const Tensor<float>& b) {
  std::vector<int> out;
  for (int i = 0; i < a.rows(); ++i)
    if ((a.row(i) - b.row(i)).cwiseAbs().maxCoeff() > 1e-5F * (1 + a.row(i).cwiseAbs().maxCoeff())) out.push_back(i);
  return out;
}

TEST_CASE("a shifted rod differs in positions only, one turned about the vertical in horizontal ones and rotations") {
  const Rod rod = test::random_rod(test::tree(2, 2), {0}, 3);
  const Encoded here = encoded(Encoding::paper_residual, rod, 1);
  Rod shifted = rod, turned = rod;
  test::move_rigidly(shifted, Quaternion::Identity(), {1, -2, 3});
  test::move_rigidly(turned, Quaternion(Eigen::AngleAxisd(0.7, Vector3::UnitY())), Vector3::Zero());
  const Encoded there = encoded(Encoding::paper_residual, shifted, 1),
                spun = encoded(Encoding::paper_residual, turned, 1);
  CHECK(changed(here.nodes, there.nodes) == std::vector<int>{0, 1, 2});
  CHECK(changed(here.nodes, spun.nodes) == std::vector<int>{0, 2, 3, 4, 5, 6});
  CHECK(changed(here.edges, there.edges).empty());
  CHECK(changed(here.edges, spun.edges).empty());
}

TEST_CASE("alpha and the flags count from the static segment, along branches and around loops") {
  const Encoded chain = encoded(Encoding::paper_residual, test::random_rod(test::chain(4), {3}, 1));
  CHECK(chain.nodes.row(13) == Eigen::RowVector4f(1, 0, 0, 0));  // last
  CHECK(chain.nodes.row(12) == Eigen::RowVector4f(0, 0, 0, 1));  // first
  CHECK(chain.nodes.row(11) == Eigen::RowVector4f(0, 0, 0, 1));  // fixed
  CHECK(chain.nodes(10, 0) == 1);
  CHECK(chain.nodes(10, 3) == 0);
  for (int i = 1; i < 4; ++i) CHECK(chain.nodes(10, i) < chain.nodes(10, i - 1));

  const Encoded tree = encoded(Encoding::paper_residual, test::random_rod(test::tree(2, 2), {}, 1));
  CHECK(tree.nodes.row(11).isZero());
  CHECK(tree.nodes.row(12).sum() == 1);
  CHECK(tree.nodes.row(13).sum() == 4);
  CHECK(tree.nodes(10, 0) == 0);
  CHECK(tree.nodes.row(10).maxCoeff() == 1);

  const Encoded ring = encoded(Encoding::paper_residual, test::random_rod(test::ring(5), {0}, 1));
  CHECK(ring.nodes.row(13).isZero());
  CHECK(ring.nodes(10, 1) < ring.nodes(10, 2));
  CHECK(ring.nodes(10, 4) < ring.nodes(10, 3));
}

TEST_CASE("a wall without radius and a joint without compliance have finite moduli") {
  const Scene scene = build_scene(test::bending_rod(4, Clamp::wall));
  const Encoded e = encoded(Encoding::paper, scene.rods.front());
  CHECK(e.nodes.allFinite());
  CHECK(e.edges(3, 0) == Approx(e.edges(3, 1)));
  Rod rigid = scene.rods.front();
  rigid.joints[0].compliance.setZero();
  CHECK(encoded(Encoding::paper, rigid).edges(3, 0) == 1e15F);
}

}  // namespace rodsweep::test_graph_encoding
