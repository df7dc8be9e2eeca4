// The cost of the linear system of nets and lattices over their size: pattern, plan of the factorisation, assembly,
// product with A, direct solve, and a learned guess of all couplings. The guess has latent size 32, no training and no
// base guess: features, factors, one correction, both products; also with factors of an earlier step. Google Benchmark
// times the cases; a final table has them by number of joints, and the direct solve over the product, as ratios from
// this run.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <utility>
#include <vector>

#include "network/guess/coping_net_guess.hpp"
#include "solver/factor/block_factor.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

SceneSpec lattice(Lattice::Cell cell, int nodes) {
  Lattice p;
  p.cell = cell;
  p.nodes_x = nodes;
  p.radius_m = 0.01;
  p.youngs_modulus_pa = 1e6;
  p.torsion_modulus_pa = 4e5;
  return p;
}

SceneSpec net(int rods) {
  Net p;
  p.rows = p.columns = rods;
  p.radius_m = 0.01;
  p.youngs_modulus_pa = 1e6;
  p.torsion_modulus_pa = 4e5;
  return p;
}

using Cell = Lattice::Cell;
const std::vector<std::pair<const char*, SceneSpec>> scenes{
    {"net 8x8", net(8)},
    {"net 16x16", net(16)},
    {"net 32x32", net(32)},
    {"net 64x64", net(64)},
    {"cubic 5^3", lattice(Cell::cubic, 5)},
    {"cubic 8^3", lattice(Cell::cubic, 8)},
    {"cubic 12^3", lattice(Cell::cubic, 12)},
    {"cubic 16^3", lattice(Cell::cubic, 16)},
    {"body-centred 5^3", lattice(Cell::body_centred, 5)},
    {"octet 4^3", lattice(Cell::octet, 4)},
};

const SceneSpec& scene_of(const benchmark::State& state) {
  return scenes[static_cast<std::size_t>(state.range(0))].second;
}

/// An assembled system, as in a step.
struct Assembled {
  Scene scene;
  LinearSystem system;
  VectorX b;

  explicit Assembled(const SceneSpec& spec) : scene(build_scene(spec)), system(rod()) {
    system.assemble(rod(), 0.02);
    b = VectorX::LinSpaced(system.matrix().unknowns(), -1, 2);
  }
  const Rod& rod() const { return scene.rods.front(); }
};

void pattern(benchmark::State& state) {
  const Scene scene = build_scene(scene_of(state));
  for (auto _ : state) benchmark::DoNotOptimize(LinearSystem(scene.rods.front()).rhs().data());
}

void plan(benchmark::State& state) {
  const Assembled a(scene_of(state));
  for (auto _ : state) BlockFactor(a.system.matrix(), root_to_leaf_order(a.rod()));
}

void assembly(benchmark::State& state) {
  Assembled a(scene_of(state));
  for (auto _ : state) a.system.assemble(a.rod(), 0.02);
}

void product(benchmark::State& state) {
  const Assembled a(scene_of(state));
  VectorX y = a.b;
  for (auto _ : state) a.system.matrix().multiply(a.b.data(), y.data());
}

void direct(benchmark::State& state) {
  const Assembled a(scene_of(state));
  VectorX x = a.b;
  BlockFactor factor(a.system.matrix(), root_to_leaf_order(a.rod()));
  for (auto _ : state)
    if (factor.solve(a.system.matrix(), a.b, x) != SolveOutcome::converged) state.SkipWithError("a solve failed");
}

void substitution(benchmark::State& state) {
  const Assembled a(scene_of(state));
  VectorX x = a.b;
  BlockFactor factor(a.system.matrix(), root_to_leaf_order(a.rod()));
  factor.factorise(a.system.matrix());
  for (auto _ : state) {
    x = a.b;
    factor.substitute(x);
  }
}

template <bool lag>
void learned(benchmark::State& state) {
  const Assembled a(scene_of(state));
  CopingNetSettings settings;
  settings.couplings = Couplings::all;
  settings.base = BaseGuess::none;
  settings.latent = 32;
  const auto model = std::make_shared<Model>(Model{CopingNet<float>(settings, 1), {}});
  CopingNetGuess guess(model, a.scene, 1, {1, lag ? 1000000 : 0, 0});
  VectorX x = a.b;
  guess.propose(a.system, {}, x);
  SolvePosition at;
  at.step = lag ? 1 : 0;
  for (auto _ : state) {
    guess.propose(a.system, at, x);
    benchmark::ClobberMemory();
  }
}

const Cases costs{{"pattern", pattern},        {"plan", plan},
                  {"assembly", assembly},      {"product", product},
                  {"direct", direct},          {"substitution", substitution},
                  {"learned", learned<false>}, {"lagging", learned<true>}};

void print_summary(const Medians& median) {
  std::printf("\nPer joint [us]; the direct solve also in products with A, and what L takes\n%-18s %8s", "", "joints");
  for (const auto& [name, function] : costs) std::printf(" %12s", name);
  std::printf(" %10s %9s\n", "products", "MiB");
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const auto& [scene, spec] = scenes[i];
    const auto of = [&](const char* name) { return median(name, static_cast<std::int64_t>(i)); };
    std::printf("%-18s %8d", scene, joint_count(spec));
    for (const auto& [name, function] : costs) std::printf(" %12.4f", 1e6 * of(name) / joint_count(spec));
    const Scene built = build_scene(spec);
    const Rod& rod = built.rods.front();
    const double bytes = plan_elimination(LinearSystem(rod).matrix(), root_to_leaf_order(rod)).bytes;
    std::printf(" %10.1f %9.1f\n", of("direct") / of("product"), bytes / (1024 * 1024));
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (std::size_t i = 0; i < scenes.size(); ++i) register_cases(costs, std::array{static_cast<std::int64_t>(i)});
  return run_benchmarks(argc, argv, print_summary);
}
