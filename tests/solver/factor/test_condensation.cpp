// Struts and crossings of a rod, and the condensed system after elimination of the struts.
#include <vector>

#include "solver/factor/condensation.hpp"
#include "solver/linear/linear_system.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_condensation {

using test::random_rod, test::shaken;

template <class Scene>
Rod rod_of(Scene p) {
  p.stretch = Stretch::physical;
  return build_scene(p).rods.front();
}

Rod lattice(Lattice::Cell cell, int nodes, int segments, Held held) {
  Lattice p = test::lattice_of(cell, nodes, segments, held);
  p.nodes_z = nodes + 1;
  return rod_of(p);
}

/// Chains, trees, rings, nets and lattices, held and free.
std::vector<Rod> rods() {
  Net net;
  net.segments = 3;
  return {random_rod(test::chain(7), {}, 1),
          random_rod(test::chain(7), {0}, 2),
          random_rod(test::chain(9), {4}, 3),
          random_rod(test::tree(3, 2), {0}, 4),
          random_rod(test::ring(6), {}, 5),
          random_rod(test::ring(6), {2}, 6),
          random_rod(test::net(4, 5), {0, 4}, 7),
          rod_of(net),
          lattice(Lattice::Cell::cubic, 3, 1, Held::side),
          lattice(Lattice::Cell::cubic, 3, 4, Held::corners),
          lattice(Lattice::Cell::body_centred, 2, 3, Held::free),
          lattice(Lattice::Cell::octet, 2, 2, Held::side)};
}

TEST_CASE("a chain has no crossing, a ring one, a net or a lattice one of each rod where rods cross") {
  CHECK(strut_graph(random_rod(test::chain(5), {0}, 1)).crossings.empty());
  const StrutGraph ring = strut_graph(random_rod(test::ring(5), {}, 1));
  CHECK(ring.crossings.size() == 1);
  CHECK(ring.struts.front().begin == ring.struts.front().end);
  Net p;
  p.rows = 3;
  p.columns = 4;
  p.segments = 5;
  p.held = Held::free;
  const StrutGraph net = strut_graph(rod_of(p));
  CHECK(net.crossings.size() == 24);
  CHECK(net.struts.size() == 17);
  CHECK(net.links.size() == 12);
  for (const Strut& strut : net.struts) CHECK(strut.segments.size() == 4);
  CHECK(strut_graph(lattice(Lattice::Cell::cubic, 3, 3, Held::free)).crossings.size() == 108);
}

TEST_CASE("a condensed system has the answer of the whole one") {
  constexpr double dt = 0.02;
  for (Rod rod : rods()) {
    rod = shaken(rod, 1);
    const LinearSystem system = test::assembled(rod, dt);
    Condensation condensation(rod);
    REQUIRE(condensation.assemble(rod, system.linearization(), dt));
    const VectorX r = test::Random(2).entries(system.matrix().unknowns());
    VectorX g, d;
    condensation.condense(r, g);
    const test::MatrixX s = condensation.matrix().dense();
    CHECK((s - s.transpose()).norm() <= 1e-12 * s.norm());
    const VectorX y = g.size() > 0 ? test::dense_solve(s, g) : g;
    condensation.expand(r, y.data(), d);
    const VectorX exact = test::dense_solve(system.matrix().dense(), r);
    CAPTURE(rod.joint_count());
    CHECK((d - exact).norm() < 1e-8 * exact.norm());

    // The residual of the crossings is the residual of the whole system.
    const VectorX other = y + 0.1 * y.norm() * test::Random(3).entries(static_cast<int>(y.size()));
    const VectorX p = g - s * other;
    condensation.expand(r, other.data(), d);
    const double left = test::residual(system.matrix(), r, d).norm();
    CHECK(condensation.residual_norm(p.data()) ==
          Approx(left).epsilon(1e-7).margin((g.size() > 0 ? 1e-9 : 1e-8) * r.norm()));
  }
}

}  // namespace rodsweep::test_condensation
