// The cost of a step of a tree in the wind: a thousand segments by each projection, the direct solve over the number of
// segments, and the share of the wind. Google Benchmark times the cases; final tables compare their medians with the
// targets, as ratios from this run.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <map>
#include <optional>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/step/pbd_projection.hpp"
#include "solver/step/time_step.hpp"
#include "solver/step/xpbd_projection.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr int sweeps = 20;  // of xpbd and pbd
constexpr double cg_tolerance = 1e-2;

/// Each branch ends in two others; 1 + 2 + ... + 2^depth branches.
Tree tree(int depth, int segments) {
  Tree p;
  p.shape.depth = depth;
  p.shape.branches = 2;
  p.shape.segments = segments;
  p.shape.length_m = 2;
  p.shape.angle_spread_deg = 15;
  p.radius_m = 0.1;
  p.youngs_modulus_pa = 1e9;
  p.torsion_modulus_pa = 4e8;
  WindParameters wind;
  wind.mean_m_s = {8, 0, 0};
  wind.turbulence_m_s = 2;
  p.wind = wind;
  return p;
}

const std::map<int, Tree> trees{{1, tree(6, 8)}, {10, tree(9, 10)}, {100, tree(12, 12)}};  // thousands of segments

/// CG with Jacobi, from zero.
class CgSolve : public LinearSolve {
 public:
  SolveOutcome solve(const LinearSystem& system, const SolvePosition&, double, VectorX& delta_lambda) override {
    if (!cg_) cg_.emplace(system.matrix(), CgSettings{});
    cg_->matrix_changed();
    delta_lambda.setZero();
    return cg_->solve(system.rhs(), delta_lambda, false, cg_tolerance, cg_->norm_of(system.rhs())).outcome;
  }

 private:
  std::optional<ConjugateGradient> cg_;
};

/// Steps by a projection of a tree that direct steps have set in motion. Newton takes one iteration.
void steps(benchmark::State& state, Scene& scene, Projection& projection, int iterations = 1) {
  {
    DirectSolve direct(scene);
    LinearProjection exact(scene, direct);
    TimeStepper stepper(scene, {0.02, 3, 1e-9});
    for (int i = 0; i < 10; ++i) stepper.step(exact);
  }
  TimeStepper stepper(scene, {0.02, iterations, 0});
  for (auto _ : state)
    if (stepper.step(projection).outcome != SolveOutcome::converged) state.SkipWithError("a solve failed");
}

Scene scene_of(const benchmark::State& state) { return build_scene(trees.at(static_cast<int>(state.range(0)))); }

void direct(benchmark::State& state) {
  Scene scene = scene_of(state);
  DirectSolve solve(scene);
  LinearProjection projection(scene, solve);
  steps(state, scene, projection);
}

void calm(benchmark::State& state) {
  Scene scene = scene_of(state);
  scene.wind.reset();
  DirectSolve solve(scene);
  LinearProjection projection(scene, solve);
  steps(state, scene, projection);
}

void cg(benchmark::State& state) {
  Scene scene = scene_of(state);
  CgSolve solve;
  LinearProjection projection(scene, solve);
  steps(state, scene, projection);
}

void xpbd(benchmark::State& state) {
  Scene scene = scene_of(state);
  XpbdProjection projection(scene);
  steps(state, scene, projection, sweeps);
}

void pbd(benchmark::State& state) {
  Scene scene = scene_of(state);
  PbdProjection projection(scene, {});
  steps(state, scene, projection, sweeps);
}

void print_summary(const Medians& median) {
  std::printf("\nA step of a tree of %d segments [ms]\n", segment_count(trees.at(1)));
  std::printf("  direct, one Newton iteration      %8.3f\n", 1e3 * median("direct/1"));
  std::printf("  cg with jacobi from zero to %g  %8.3f\n", cg_tolerance, 1e3 * median("cg/1"));
  std::printf("  xpbd, %d iterations               %8.3f\n", sweeps, 1e3 * median("xpbd/1"));
  std::printf("  pbd, %d iterations                %8.3f\n", sweeps, 1e3 * median("pbd/1"));
  std::printf("\nDirect step, per segment (target: near linear)\n%9s %10s %12s %11s\n", "segments", "step [us]",
              "of the first", "wind [%]");
  const double first = median("direct/1") / segment_count(trees.at(1));
  for (const auto& [thousands, spec] : trees) {
    const double step = median("direct", thousands), each = step / segment_count(spec);
    std::printf("%9d %10.3f %12.2f %11.0f\n", segment_count(spec), 1e6 * each, each / first,
                100 * (1 - median("calm", thousands) / step));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const PetscSession petsc;
  for (const auto& [thousands, spec] : trees)
    register_cases({{"direct", direct}, {"calm", calm}}, std::array{thousands});
  register_cases({{"cg", cg}, {"xpbd", xpbd}, {"pbd", pbd}}, std::array{1});
  return run_benchmarks(argc, argv, print_summary);
}
