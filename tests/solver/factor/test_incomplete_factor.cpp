// Incomplete factors against dense matrices: accuracy and quality as preconditioners.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numeric>

#include "solver/factor/elimination_order.hpp"
#include "solver/factor/incomplete_factor.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/catch.hpp"
#include "tests/solver/dense.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_incomplete_factor {

using namespace test;

/// P^-1, column by column.
MatrixX applied(IncompleteFactor& factor, int unknowns) {
  MatrixX out(unknowns, unknowns);
  VectorX z(unknowns);
  for (int i = 0; i < unknowns; ++i) {
    factor.apply(VectorX::Unit(unknowns, i).eval().data(), z.data());
    out.col(i) = z;
  }
  return out;
}

/// The smallest and the largest eigenvalue of P^-1 A.
std::pair<double, double> spectrum(IncompleteFactor& factor, const BlockMatrix& a) {
  const Eigen::VectorXcd values = (applied(factor, a.unknowns()) * a.dense()).eigenvalues();
  return {values.real().minCoeff(), values.real().maxCoeff()};
}

double asymmetry(const MatrixX& m) { return (m - m.transpose()).norm() / m.norm(); }

TEST_CASE("the applied operator is symmetric and positive definite, and nearer the inverse with more fill") {
  Lattice lattice = lattice_of(Lattice::Cell::cubic, 3, 2);
  lattice.nodes_y = lattice.nodes_z = 2;
  lattice.youngs_modulus_pa = 1e6;
  lattice.radius_m = 0.01;
  const LinearSystem system = assembled(build_scene(lattice).rods.front());
  const BlockMatrix& a = system.matrix();
  double scattered = 1e30;  // ||P^-1 A - 1||^2
  for (const int levels : {0, 1, 3, 1000}) {
    INFO(levels);
    IncompleteFactor factor(a, breadth_first_order(a), levels);
    REQUIRE(factor.factorise(a));
    const MatrixX inverse = applied(factor, a.unknowns());
    CHECK(asymmetry(inverse) < 1e-5);
    CHECK(spectrum(factor, a).first > 0);
    const double now = (inverse * a.dense() - MatrixX::Identity(a.unknowns(), a.unknowns())).squaredNorm();
    CHECK(now < scattered);
    scattered = now;
  }
}

TEST_CASE("with all fill it is the inverse, in any order, and on chains and trees with none") {
  const auto near_inverse = [](const BlockMatrix& a, const std::vector<int>& order, int levels) {
    IncompleteFactor factor(a, order, levels);
    REQUIRE(factor.factorise(a));
    CHECK(factor.shift() == 0);
    const auto [least, largest] = spectrum(factor, a);
    CHECK(least > 0.95);  // limited by single precision and the condition of inextensible joints
    CHECK(largest < 1.05);
    return factor.off_diagonal_blocks();
  };
  const LinearSystem on_net = assembled(random_rod(net(4, 4), {0}, 3));
  const BlockMatrix& a = on_net.matrix();
  std::vector<int> given(static_cast<std::size_t>(a.block_rows()));
  std::iota(given.begin(), given.end(), 0);
  for (const std::vector<int>& order : {given, breadth_first_order(a), minimum_degree_order(a)})
    near_inverse(a, order, 1000);
  for (const Rod& rod : {random_rod(chain(12), {0}, 1), random_rod(tree(3, 3), {0}, 2)}) {
    const LinearSystem open = assembled(rod);
    const int blocks = near_inverse(open.matrix(), breadth_first_order(open.matrix()), 0);
    CHECK(2 * blocks + open.matrix().block_rows() == open.matrix().block_count());
  }
}

TEST_CASE("a factor that is not positive definite is raised until it is; of a matrix that is not, there is none") {
  LinearSystem system = assembled(build_scene(slender_lattice(Lattice::Cell::octet, 3)).rods.front());
  BlockMatrix a = system.matrix();
  IncompleteFactor factor(a, breadth_first_order(a), 1);
  REQUIRE(factor.factorise(a));
  CHECK(factor.shift() > 0);
  CHECK(factor.shift() < 0.1);
  VectorX r = VectorX::Random(a.unknowns()), z(r);
  factor.apply(r.data(), z.data());
  CHECK(r.dot(z) > 0);

  for (const double scale : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    BlockMatrix bad = a;
    for (Lane8& column : bad.blocks[bad.diagonal(7)].column) column *= broadcast(scale);
    CHECK_FALSE(factor.factorise(bad));
  }
  VectorX again(z);
  REQUIRE(factor.factorise(a));
  factor.apply(r.data(), again.data());
  CHECK(again == z);
}

TEST_CASE("the units of a matrix do not matter, far beyond the range of single precision") {
  const LinearSystem system = assembled(random_rod(net(3, 3), {0}, 3));
  BlockMatrix a = system.matrix();
  IncompleteFactor factor(a, breadth_first_order(a), 1);
  REQUIRE(factor.factorise(a));
  const VectorX r = VectorX::Random(a.unknowns());
  VectorX z(r), scaled(r);
  factor.apply(r.data(), z.data());
  for (const double scale : {std::exp2(-150), std::exp2(150)}) {
    for (std::size_t k = 0; k < a.blocks.size(); ++k)
      for (int c = 0; c < 6; ++c) a.blocks[k].column[c] = system.matrix().blocks[k].column[c] * scale;
    REQUIRE(factor.factorise(a));
    factor.apply(r.data(), scaled.data());
    CHECK(scale * scaled == z);
  }
}

}  // namespace rodsweep::test_incomplete_factor
