// The cost of the direct time step: its parts, its scaling with the number of segments, and an iteration of Gauss-Seidel
// over one of Newton.
// Google Benchmark times the cases; final tables compare their medians with the targets, as ratios from this run.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "solver/scene/scenes.hpp"
#include "solver/step/gauss_seidel.hpp"
#include "solver/step/time_step.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr int sizes[] = {10, 30, 50, 100, 500, 1000, 10000, 100000};
int segments_of(const benchmark::State& state) { return static_cast<int>(state.range(0)); }

const StepSettings one_iteration{0.02, 1, 0};

/// Segments as long as they are wide, all in motion: along a rod at rest, decaying multipliers become denormal numbers,
/// which are slow.
Scene moving_scene(int segments) {
  BendingRod rod;
  rod.segments = segments;
  rod.length_m = 0.1 * segments;
  rod.initial_angle_deg = -80;
  rod.youngs_modulus_pa = 1e6;
  Scene scene = build_scene(rod);
  for (int s = 1; s < segments; ++s)
    scene.rods[0].angular_velocity[static_cast<std::size_t>(s)] = {std::sin(1.7 * s), std::cos(2.3 * s), std::sin(s)};
  return scene;
}

/// A scene with the objects that its step and the parts of the step need, shared by all cases.
struct Single {
  Scene scene;
  DirectSolve direct;
  LinearProjection projection, balanced;
  TimeStepper stepper;
  LinearSystem system;
  BlockFactor factor;
  VectorX solution;

  explicit Single(int segments)
      : scene(moving_scene(segments)),
        direct(scene),
        projection(scene, direct),
        balanced(scene, direct, 0),
        stepper(scene, one_iteration),
        system(rod()),
        factor(system.matrix(), root_to_leaf_order(rod())),
        solution(VectorX::Zero(system.rhs().size())) {
    balanced.keep_balance(true);
  }
  Single(const Single&) = delete;
  Single& operator=(const Single&) = delete;

  Rod& rod() { return scene.rods.front(); }

  static Single& of(const benchmark::State& state) {
    static std::map<int, Single> made;
    return made.try_emplace(segments_of(state), segments_of(state)).first->second;
  }
};

void step(benchmark::State& state) {
  Single& single = Single::of(state);
  for (auto _ : state)
    if (single.stepper.step(single.projection).outcome != SolveOutcome::converged)
      state.SkipWithError("a solve failed");
}

/// Two Newton iterations, so that joints stay closed. Rods start anew when they have moved for a second.
void step_by(benchmark::State& state, Integrator integrator) {
  Scene scene = moving_scene(segments_of(state));
  const Scene start = scene;
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  std::optional<TimeStepper> stepper;
  for (auto _ : state) {
    if (!stepper || stepper->steps_taken() == 50) {
      state.PauseTiming();
      scene = start;
      stepper.emplace(scene, StepSettings{one_iteration.dt, 2, 0, integrator});
      state.ResumeTiming();
    }
    if (stepper->step(projection).outcome != SolveOutcome::converged) state.SkipWithError("a solve failed");
  }
}

void step_euler(benchmark::State& state) { step_by(state, Integrator::euler); }
void step_bdf2(benchmark::State& state) { step_by(state, Integrator::bdf2); }

void linearize(benchmark::State& state) {
  Single& single = Single::of(state);
  Linearization out(single.rod());
  for (auto _ : state) {
    linearize(single.rod(), out);
    benchmark::ClobberMemory();
  }
}

void assemble(benchmark::State& state) {
  Single& single = Single::of(state);
  for (auto _ : state) {
    single.system.assemble(single.rod(), one_iteration.dt);
    benchmark::ClobberMemory();
  }
}

void factor_and_solve(benchmark::State& state) {
  Single& single = Single::of(state);
  single.system.assemble(single.rod(), one_iteration.dt);
  for (auto _ : state)
    benchmark::DoNotOptimize(single.factor.solve(single.system.matrix(), single.system.rhs(), single.solution));
}

void update(benchmark::State& state) {
  Single& single = Single::of(state);
  Rod rod = single.rod();
  single.system.assemble(rod, one_iteration.dt);
  single.solution.setConstant(1e-20);  // the update hardly moves anything
  for (auto _ : state) {
    single.system.apply(rod, single.solution);
    benchmark::ClobberMemory();
  }
}

/// One call of project() on rods that keep moving towards their constraints.
void iterate(benchmark::State& state, Projection& projection, Rod& rod) {
  for (auto _ : state)
    if (projection.project(rod, {}, one_iteration.dt, 0).outcome == SolveOutcome::indefinite)
      state.SkipWithError("a projection failed");
}

void newton(benchmark::State& state) {
  Single& single = Single::of(state);
  Rod rod = single.rod();
  iterate(state, single.projection, rod);
}

void newton_balanced(benchmark::State& state) {
  Single& single = Single::of(state);
  Rod rod = single.rod();
  iterate(state, single.balanced, rod);
}

void xpbd(benchmark::State& state) {
  const Scene& scene = Single::of(state).scene;
  XpbdProjection projection(scene);
  Rod rod = scene.rods.front();
  iterate(state, projection, rod);
}

void pbd(benchmark::State& state) {
  const Scene& scene = Single::of(state).scene;
  PbdProjection projection(scene, {});
  Rod rod = scene.rods.front();
  iterate(state, projection, rod);
}

double us(const Medians& median, const char* name, int n) { return median(name, n) / n * 1e6; }

void print_summary(const Medians& median) {
  std::printf(
      "\nDirect step, one Newton iteration, per segment (targets: at most 0.5 us from N = 30 on, assembly at most"
      " 25 %%)\n");
  std::printf("%6s %10s %15s %14s %16s %11s\n", "N", "step [us]", "linearise [%]", "assemble [%]", "factor+solve [%]",
              "update [%]");
  for (const int n : sizes) {
    const double whole = us(median, "step", n), assembly = us(median, "assemble", n);
    std::printf("%6d %10.3f %15.0f %14.0f %16.0f %11.0f\n", n, whole, 100 * us(median, "linearize", n) / whole,
                100 * assembly / whole, 100 * us(median, "factor_and_solve", n) / whole,
                100 * us(median, "update", n) / whole);
  }
  std::printf(
      "\nOne iteration of each projection, per segment (a step takes one to six of Newton's, tens of the others)\n");
  std::printf("%6s %12s %10s %10s %14s %13s\n", "N", "direct [us]", "xpbd [us]", "pbd [us]", "xpbd / direct",
              "pbd / direct");
  for (const int n : sizes) {
    const double direct = us(median, "newton", n);
    std::printf("%6d %12.3f %10.3f %10.3f %14.2f %13.2f\n", n, direct, us(median, "xpbd", n), us(median, "pbd", n),
                us(median, "xpbd", n) / direct, us(median, "pbd", n) / direct);
  }
}

void print_ratio(const Medians& median, const char* title, const char* one, const char* other) {
  std::printf("\n%s\n%6s %20s %20s %8s\n", title, "N", one, other, "ratio");
  for (const int n : sizes)
    std::printf("%6d %20.3f %20.3f %8.2f\n", n, us(median, one, n), us(median, other, n),
                us(median, other, n) / us(median, one, n));
}

}  // namespace

int main(int argc, char** argv) {
  register_cases({{"step", step},
                  {"step_euler", step_euler},
                  {"step_bdf2", step_bdf2},
                  {"linearize", linearize},
                  {"assemble", assemble},
                  {"factor_and_solve", factor_and_solve},
                  {"update", update},
                  {"newton", newton},
                  {"newton_balanced", newton_balanced},
                  {"xpbd", xpbd},
                  {"pbd", pbd}},
                 sizes);
  return run_benchmarks(argc, argv, [](const Medians& medians) {
    print_summary(medians);
    print_ratio(medians, "A Newton iteration in balance of momentum over one of the paper's step [us]", "newton",
                "newton_balanced");
    print_ratio(medians, "A step of BDF2 over one of Euler, two Newton iterations [us] (target: at most 1.05)",
                "step_euler", "step_bdf2");
  });
}
