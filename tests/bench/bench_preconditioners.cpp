// What preconditioners of CG cost on cubic lattices, per joint: a product with the matrix, an iteration, a set-up; and
// a whole solve from zero, set-up included, with its iterations. Google Benchmark times the cases; at the end a table
// sets their medians beside each other, as measured in this run.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <memory>
#include <string>

#include "solver/linear/conjugate_gradient.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/linear/petsc_session.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr int sizes[] = {3, 5, 8};    // nodes along an edge
constexpr int most_for_all_fill = 5;  // beyond, a complete factor takes long to plan
constexpr int iterations = 3;         // few, for preconditioners that are nearly exact
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

ConjugateGradient cg_of(const Kind& kind, const Case& c, int most) {
  return {c.system.matrix(), {kind.preconditioner, Norm::true_residual, most, kind.fill_levels}};
}

void multiply(benchmark::State& state) {
  const Case& c = case_of(static_cast<int>(state.range(0)));
  VectorX y = c.x;
  for (auto _ : state) {
    c.system.matrix().multiply(c.system.rhs().data(), y.data());
    benchmark::ClobberMemory();
  }
}

/// With a preconditioner that is made anew, or kept.
void iterate(benchmark::State& state, const Kind& kind, bool anew) {
  Case& c = case_of(static_cast<int>(state.range(0)));
  ConjugateGradient cg = cg_of(kind, c, iterations);
  for (auto _ : state) {
    if (anew) cg.matrix_changed();
    if (cg.solve(c.system.rhs(), c.x, false, 0, 1).iterations != iterations) state.SkipWithError("CG ended early");
  }
}

int solve_once(Case& c, ConjugateGradient& cg) {
  cg.matrix_changed();
  return cg.solve(c.system.rhs(), c.x, false, tolerance, c.system.rhs().norm()).iterations;
}

void solve(benchmark::State& state, const Kind& kind) {
  Case& c = case_of(static_cast<int>(state.range(0)));
  ConjugateGradient cg = cg_of(kind, c, 0);
  for (auto _ : state) benchmark::DoNotOptimize(solve_once(c, cg));
}

template <class Visit>
void for_all(const Visit& visit) {
  for (const Kind& kind : kinds)
    for (const int nodes : sizes)
      if (kind.preconditioner != Preconditioner::cholesky || nodes <= most_for_all_fill) visit(kind, nodes);
}

std::string at(const std::string& name, int nodes) { return name + "/" + std::to_string(nodes); }

void print_summary(const Medians& median) {
  std::printf("\nPreconditioners on cubic lattices, per joint [ns]; a solve is to %.0e from zero\n", tolerance);
  std::printf("%-20s %6s %8s %8s %10s %8s %8s %6s\n", "", "nodes", "joints", "product", "iteration", "set-up", "solve",
              "its");
  for_all([&](const Kind& kind, int nodes) {
    Case& c = case_of(nodes);
    const int joints = c.system.matrix().block_rows();
    const auto per_joint = [&](const std::string& name) { return median(at(name, nodes)) / joints * 1e9; };
    const std::string name = kind.name;
    const double kept = per_joint("kept " + name);
    ConjugateGradient cg = cg_of(kind, c, 0);
    std::printf("%-20s %4d^3 %8d %8.1f %10.1f %8.1f %8.0f %6d\n", kind.name, nodes, joints, per_joint("multiply"),
                kept / iterations, per_joint("anew " + name) - kept, per_joint("solve " + name), solve_once(c, cg));
  });
}

}  // namespace

int main(int argc, char** argv) {
  const PetscSession petsc;
  for (const int nodes : sizes)
    benchmark::RegisterBenchmark("multiply", multiply)->Arg(nodes)->Unit(benchmark::kNanosecond);
  for_all([](const Kind& kind, int nodes) {
    const std::string name = kind.name;
    const auto add = [&](const std::string& prefix, const auto& function) {
      benchmark::RegisterBenchmark((prefix + name).c_str(), function)->Arg(nodes)->Unit(benchmark::kNanosecond);
    };
    add("kept ", [&kind](benchmark::State& state) { iterate(state, kind, false); });
    add("anew ", [&kind](benchmark::State& state) { iterate(state, kind, true); });
    add("solve ", [&kind](benchmark::State& state) { solve(state, kind); });
  });
  Medians medians;
  if (!run_benchmarks(argc, argv, medians)) return 2;
  print_summary(medians);
}
