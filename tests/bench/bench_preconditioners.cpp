// The cost of CG on cubic lattices, per joint: a product with and without the blocks of the matrix, an iteration with
// each preconditioner, its set-up, and a whole solve from zero with set-up and iterations. An iteration of a condensed
// system includes the start of every solve. Google Benchmark times the cases; a final table compares their medians from
// this run.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <memory>
#include <string>

#include "solver/cg/cg_solver.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr int product_sizes[] = {3, 4, 5, 8, 12, 18};  // nodes along an edge
constexpr int sizes[] = {3, 5, 8};
constexpr int most_for_all_fill = 5;  // the plan of a complete factor takes long for larger sizes
constexpr int iterations = 3;         // few, since some preconditioners are almost exact
constexpr double tolerance = 1e-2;

struct Kind {
  const char* name;
  Preconditioner preconditioner;
  int fill_levels;
};
constexpr Kind kinds[] = {{"jacobi", Preconditioner::jacobi, 0},
                          {"point_block_jacobi", Preconditioner::point_block_jacobi, 0},
                          {"icc", Preconditioner::icc, 0},
                          {"block_icc 0", Preconditioner::block_icc, 0},
                          {"block_icc 1", Preconditioner::block_icc, 1},
                          {"block_icc 3", Preconditioner::block_icc, 3},
                          {"condensed 1", Preconditioner::condensed, 1},
                          {"condensed 3", Preconditioner::condensed, 3},
                          {"cholesky", Preconditioner::cholesky, 0}};

struct Case {
  Scene scene;
  LinearSystem system;
  VectorX x;

  explicit Case(const Lattice& lattice) : scene(build_scene(lattice)), system(scene.rods.front()) {
    system.assemble(scene.rods.front(), 0.02);
    x = VectorX::Zero(system.rhs().size());
  }
};

Case& case_of(int nodes) {
  static std::map<int, std::unique_ptr<Case>> cases;
  std::unique_ptr<Case>& found = cases[nodes];
  if (!found) {
    Lattice lattice;
    lattice.nodes_x = nodes;
    lattice.radius_m = 0.01;
    lattice.youngs_modulus_pa = 1e6;
    lattice.torsion_modulus_pa = 4e5;
    found = std::make_unique<Case>(lattice);
  }
  return *found;
}

std::unique_ptr<CgSolver> cg_of(const Kind& kind, const Case& c, int most) {
  return make_cg(c.scene.rods.front(), c.system, {kind.preconditioner, Norm::true_residual, most, kind.fill_levels});
}

template <class Product>
void multiply(benchmark::State& state, const Case& c, const Product& product) {
  VectorX y = c.x;
  for (auto _ : state) {
    product.multiply(c.system.rhs().data(), y.data());
    benchmark::ClobberMemory();
  }
}

void with_blocks(benchmark::State& state) {
  const Case& c = case_of(static_cast<int>(state.range(0)));
  multiply(state, c, c.system.matrix());
}

void without_blocks(benchmark::State& state) {
  const Case& c = case_of(static_cast<int>(state.range(0)));
  const Rod& rod = c.scene.rods.front();
  ConstraintProduct product(rod);
  product.update(rod, c.system.linearization(), 1);
  multiply(state, c, product);
}

/// `anew`: sets up the preconditioner again.
void iterate(benchmark::State& state, const Kind& kind, bool anew) {
  Case& c = case_of(static_cast<int>(state.range(0)));
  const std::unique_ptr<CgSolver> cg = cg_of(kind, c, iterations);
  for (auto _ : state) {
    if (anew) cg->matrix_changed();
    if (cg->solve(c.system.rhs(), c.x, false, 0, 1).iterations != iterations) state.SkipWithError("CG ended early");
  }
}

int solve_once(Case& c, CgSolver& cg) {
  cg.matrix_changed();
  return cg.solve(c.system.rhs(), c.x, false, tolerance, c.system.rhs().norm()).iterations;
}

void solve(benchmark::State& state, const Kind& kind) {
  Case& c = case_of(static_cast<int>(state.range(0)));
  const std::unique_ptr<CgSolver> cg = cg_of(kind, c, 0);
  for (auto _ : state) benchmark::DoNotOptimize(solve_once(c, *cg));
}

template <class Visit>
void for_all(const Visit& visit) {
  for (const Kind& kind : kinds)
    for (const int nodes : sizes)
      if (kind.preconditioner != Preconditioner::cholesky || nodes <= most_for_all_fill) visit(kind, nodes);
}

void print_summary(const Medians& median) {
  const auto per_joint = [&](const std::string& name, int nodes) {
    return median(name, nodes) / case_of(nodes).system.matrix().block_rows() * 1e9;
  };
  std::printf("\nProducts on cubic lattices, per joint [ns]\n%6s %8s %12s %14s %8s\n", "nodes", "joints", "with blocks",
              "without blocks", "ratio");
  for (const int nodes : product_sizes) {
    const double with = per_joint("with_blocks", nodes), without = per_joint("without_blocks", nodes);
    std::printf("%4d^3 %8d %12.1f %14.1f %8.2f\n", nodes, case_of(nodes).system.matrix().block_rows(), with, without,
                without / with);
  }
  std::printf("\nPreconditioners, per joint [ns]; a solve is to %.0e from zero\n", tolerance);
  std::printf("%-20s %6s %10s %8s %8s %6s\n", "", "nodes", "iteration", "set-up", "solve", "its");
  for_all([&](const Kind& kind, int nodes) {
    const std::string name = kind.name;
    const double kept = per_joint("kept " + name, nodes);
    const std::unique_ptr<CgSolver> cg = cg_of(kind, case_of(nodes), 0);
    std::printf("%-20s %4d^3 %10.1f %8.1f %8.0f %6d\n", kind.name, nodes, kept / iterations,
                per_joint("anew " + name, nodes) - kept, per_joint("solve " + name, nodes),
                solve_once(case_of(nodes), *cg));
  });
}

}  // namespace

int main(int argc, char** argv) {
  const PetscSession petsc;
  register_cases({{"with_blocks", with_blocks}, {"without_blocks", without_blocks}}, product_sizes);
  for_all([](const Kind& kind, int nodes) {
    const std::string name = kind.name;
    const auto add = [&](const std::string& prefix, const auto& function) {
      benchmark::RegisterBenchmark((prefix + name).c_str(), function)->Arg(nodes)->Unit(benchmark::kNanosecond);
    };
    add("kept ", [&kind](benchmark::State& state) { iterate(state, kind, false); });
    add("anew ", [&kind](benchmark::State& state) { iterate(state, kind, true); });
    add("solve ", [&kind](benchmark::State& state) { solve(state, kind); });
  });
  return run_benchmarks(argc, argv, print_summary);
}
