// The cost of guesses for one rod in motion. Classical ones: propose x0 and accept the solution. Learned ones: base
// guess, features, network, and the whole proposal.
#include <array>
#include <cstdio>
#include <memory>

#include "network/guess/base_guess.hpp"
#include "network/guess/coping_net_guess.hpp"
#include "network/processor/factor_inference.hpp"
#include "solver/guess/extrapolation_guess.hpp"
#include "solver/guess/regression_guess.hpp"
#include "solver/guess/subspace_guess.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/step/time_step.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr std::array<int, 2> sizes{50, 100};  // segments
constexpr std::array<int, 2> latents{16, 32};

constexpr int many_corrections = 5;

/// The settings of rods.h5, except the latent size.
CopingNetSettings settings_of(int latent) {
  CopingNetSettings settings;
  settings.base = BaseGuess::regression;
  settings.base_size = 6;
  settings.latent = latent;
  return settings;
}

using MakeGuess = std::unique_ptr<InitialGuess> (*)(const Scene&);
template <class Guess, auto... arguments>
std::unique_ptr<InitialGuess> guess_of(const Scene& scene) {
  return std::make_unique<Guess>(scene, 1, arguments...);
}
constexpr auto sliding = SubspaceGuess::Window::sliding;
constexpr auto deflation = SubspaceGuess::Use::guess_and_deflation;
constexpr std::array<std::pair<const char*, MakeGuess>, 5> classical_guesses{{
    {"quadratic", guess_of<ExtrapolationGuess, 3>},
    {"regression 6", guess_of<RegressionGuess, 6, 0>},
    {"subspace 8", guess_of<SubspaceGuess, 8, sliding>},
    {"deflation 10", guess_of<SubspaceGuess, 10, sliding, deflation>},
    {"subspace 10", guess_of<SubspaceGuess, 10, sliding>},
}};

/// One step of a classical guess with a history of 30 steps.
template <class Make>
void classical(benchmark::State& state, Make make) {
  BendingRod spec;
  spec.segments = static_cast<int>(state.range(0));
  Scene scene = build_scene(spec);
  const std::unique_ptr<InitialGuess> guess = make(scene);
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  TimeStepper stepper(scene, {0.02, 1, 0});
  LinearSystem system(scene.rods.front());
  VectorX x0(6 * scene.rods.front().joint_count()), solution(x0.size());
  SolvePosition at;
  for (; at.step < 30; ++at.step) {
    stepper.step(projection);
    system.assemble(scene.rods.front(), 0.02);
    direct.solve(system, at, 0, solution);
    guess->prepare(at);
    guess->propose(system, at, x0);
    guess->accept(system, at, solution);
  }
  for (auto _ : state) {
    guess->prepare(at);
    guess->propose(system, at, x0);
    guess->accept(system, at, solution);
    ++at.step;
    benchmark::ClobberMemory();
  }
}

/// A bending rod after some steps, and guesses with its history.
struct Case {
  Scene scene;
  std::unique_ptr<LinearSystem> system;
  std::shared_ptr<const Model> model;
  std::unique_ptr<InitialGuess> base;
  std::unique_ptr<CopingNetGuess> guess;
  VectorX x0;
  SolvePosition last;

  Case(int segments, int latent, FactorUse use = {}) {
    BendingRod spec;
    spec.segments = segments;
    scene = build_scene(spec);
    const CopingNetSettings settings = settings_of(latent);
    model = std::make_shared<Model>(Model{CopingNet<float>(settings, 1), {}});
    base = base_guess(settings, scene, 1);
    guess = std::make_unique<CopingNetGuess>(model, scene, 1, use);
    system = std::make_unique<LinearSystem>(scene.rods.front());
    DirectSolve direct(scene);
    LinearProjection projection(scene, direct);
    TimeStepper stepper(scene, {0.02, 1, 0});
    x0.resize(6 * scene.rods.front().joint_count());
    VectorX solution(x0.size());
    for (last.step = 0; last.step < 30; ++last.step) {
      stepper.step(projection);
      system->assemble(scene.rods.front(), 0.02);
      direct.solve(*system, last, 0, solution);
      guess->propose(*system, last, x0);
      for (InitialGuess* one : {base.get(), static_cast<InitialGuess*>(guess.get())})
        one->accept(*system, last, solution);
    }
    system->assemble(scene.rods.front(), 0.02);
  }
};

/// `lag`: reuses the factors of an earlier step.
template <int corrections, bool lag = false>
void whole(benchmark::State& state) {
  Case c(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), {corrections, lag ? 1000000 : 0, 0});
  for (auto _ : state) {
    c.guess->propose(*c.system, c.last, c.x0);
    benchmark::ClobberMemory();
  }
}

void base_alone(benchmark::State& state) {
  Case c(static_cast<int>(state.range(0)), 16);
  for (auto _ : state) {
    c.base->propose(*c.system, c.last, c.x0);
    benchmark::ClobberMemory();
  }
}

void features(benchmark::State& state) {
  Case c(static_cast<int>(state.range(0)), 16);
  FeatureEncoder encoder(c.model->net.settings(), c.scene.rods.front(), c.system->matrix());
  Tensor<float> nodes(0, c.scene.rods.front().segment_count()), edges(SystemEncoding::size, state.range(0) - 1);
  for (auto _ : state) {
    encoder.encode(c.scene.rods.front(), *c.system, 0, c.x0, c.system->rhs(), nodes, edges);
    benchmark::ClobberMemory();
  }
}

void network(benchmark::State& state) {
  Case c(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Rod& rod = c.scene.rods.front();
  const CopingNet<float>& net = c.model->net;
  FeatureEncoder encoder(net.settings(), rod, c.system->matrix());
  Tensor<float> nodes(0, rod.segment_count()), features(SystemEncoding::size, rod.joint_count());
  encoder.encode(rod, *c.system, 0, c.x0, c.system->rhs(), nodes, features);
  FactorInference inference(net.factors(), net.parameters(), encoder.topology().forest, encoder.pattern());
  for (auto _ : state) {
    inference.factorise(features, encoder.system()->frames(), c.system->matrix());
    inference.solve(c.system->rhs(), c.x0);
    benchmark::ClobberMemory();
  }
}

void print_summary(const Medians& median) {
  std::printf("\nClassical guesses, us per segment to propose x0 and hear of the solution\n%9s", "segments");
  for (const auto& [name, make] : classical_guesses) std::printf(" %13s", name);
  std::printf("\n");
  for (const int n : sizes) {
    std::printf("%9d", n);
    for (const auto& [name, make] : classical_guesses) std::printf(" %13.4f", median(name, n) / n * 1e6);
    std::printf("\n");
  }
  std::printf("\nA learned guess (factors on regression 6), us per segment\n");
  std::printf("%9s %7s %9s %7s %9s %9s %8s %9s\n", "segments", "latent", "weights", "base", "features", "network",
              "GFLOP/s", "whole");
  for (const int n : sizes)
    for (const int latent : latents) {
      const std::string size = "/" + std::to_string(n), both = size + "/" + std::to_string(latent);
      const CopingNet<float> net(settings_of(latent), 1);
      const auto weights = static_cast<double>(net.parameters().values().size());
      const auto per_segment = [&](double seconds) { return seconds / n * 1e6; };
      const double seconds = median("network" + both);
      std::printf("%9d %7d %9.0f %7.3f %9.3f %9.3f %8.0f %9.3f\n", n, latent, weights,
                  per_segment(median("base" + size)), per_segment(median("features" + size)), per_segment(seconds),
                  2 * weights * n / seconds * 1e-9, per_segment(median("whole" + both)));
      std::printf("%59s %.3f, with factors of an earlier step %.3f\n", "every further correction",
                  per_segment(median("whole_again" + both) - median("whole" + both)) / (many_corrections - 1),
                  per_segment(median("whole_lagging" + both)));
    }
}

}  // namespace

int main(int argc, char** argv) {
  for (const int n : sizes) {
    for (const auto& [name, make] : classical_guesses)
      benchmark::RegisterBenchmark(name, [make = make](benchmark::State& state) { classical(state, make); })->Arg(n);
    benchmark::RegisterBenchmark("base", base_alone)->Arg(n);
    benchmark::RegisterBenchmark("features", features)->Arg(n);
    for (const int latent : latents) {
      benchmark::RegisterBenchmark("network", network)->Args({n, latent});
      benchmark::RegisterBenchmark("whole", whole<1>)->Args({n, latent});
      benchmark::RegisterBenchmark("whole_again", whole<many_corrections>)->Args({n, latent});
      benchmark::RegisterBenchmark("whole_lagging", whole<1, true>)->Args({n, latent});
    }
  }
  return run_benchmarks(argc, argv, print_summary);
}
