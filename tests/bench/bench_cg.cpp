// The cost of a CG iteration. Google Benchmark times the cases; a final table compares their medians with the target,
// as ratios from this run.
#include <benchmark/benchmark.h>

#include <cstdio>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/step/time_step.hpp"
#include "tests/bench/bare_cg.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr int sizes[] = {10, 30, 50, 100, 500};
constexpr int cg_iterations = 100;

BendingRod rod_of(int segments) {
  BendingRod rod;
  rod.segments = segments;
  rod.length_m = 2;
  rod.initial_angle_deg = 20;
  rod.youngs_modulus_pa = 1e6;
  return rod;
}

/// A rod in the middle of its motion.
Scene moving_scene(int segments) {
  Scene scene = build_scene(rod_of(segments));
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  TimeStepper stepper(scene, {0.02, 6, 1e-9});
  for (int i = 0; i < 20; ++i) stepper.step(projection);
  return scene;
}

void multiply(benchmark::State& state) {
  const Scene scene = moving_scene(static_cast<int>(state.range(0)));
  LinearSystem system(scene.rods.front());
  system.assemble(scene.rods.front(), 0.02);
  const VectorX x = VectorX::Random(system.rhs().size());
  VectorX y = x;
  for (auto _ : state) {
    system.matrix().multiply(x.data(), y.data());
    benchmark::ClobberMemory();
  }
}

/// Runs `cg_iterations` iterations on a random right-hand side; none of the sizes converges exactly by then.
struct CgCase {
  Scene scene;
  LinearSystem system;
  VectorX b, x;

  explicit CgCase(int segments) : scene(moving_scene(segments)), system(scene.rods.front()) {
    system.assemble(scene.rods.front(), 0.02);
    b = VectorX::Random(system.rhs().size());
    x = VectorX::Zero(b.size());
  }
};

void bare_cg(benchmark::State& state) {
  CgCase c(static_cast<int>(state.range(0)));
  BareCg cg(c.system.matrix());
  for (auto _ : state) benchmark::DoNotOptimize(cg.run(c.b, c.x, cg_iterations));
}

void petsc_cg(benchmark::State& state) {
  CgCase c(static_cast<int>(state.range(0)));
  ConjugateGradient cg(c.system.matrix(), {Preconditioner::jacobi, Norm::true_residual, cg_iterations});
  for (auto _ : state) {
    const CgReport report = cg.solve(c.b, c.x, false, 0, 1);
    if (report.iterations != cg_iterations) state.SkipWithError("CG ended early");
  }
}

void print_summary(const Medians& median) {
  std::printf("\nCG per iteration, Jacobi (target: KSP at most 1.3 times the bare loop)\n");
  std::printf("%6s %14s %14s %8s %22s\n", "N", "bare [us]", "KSPCG [us]", "ratio", "product, of bare [%]");
  for (const int n : sizes) {
    const double bare = median("bare_cg", n) / cg_iterations, petsc = median("petsc_cg", n) / cg_iterations;
    std::printf("%6d %14.3f %14.3f %8.2f %22.0f\n", n, bare * 1e6, petsc * 1e6, petsc / bare,
                100 * median("multiply", n) / bare);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const PetscSession petsc;
  register_cases({{"multiply", multiply}, {"bare_cg", bare_cg}, {"petsc_cg", petsc_cg}}, sizes);
  return run_benchmarks(argc, argv, print_summary);
}
