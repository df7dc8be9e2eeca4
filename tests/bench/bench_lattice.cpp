// The cost of the linear system of nets and lattices over their size: pattern, plan of the factorisation, assembly,
// product with A, direct solve, and a learned guess of all couplings. The guess has latent size 32, no training and no
// base guess: features, factors, one correction, both products; also with factors of an earlier step. Google Benchmark
// times the cases; a final table has them by number of joints, and the direct solve over the product, as ratios from
// this run. A second table compares direct solves (factor and solve, without plans): by the factor of A ("whole"), by
// that of the condensed system, and by CHOLMOD's supernodal factor of A on one thread.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "network/guess/coping_net_guess.hpp"
#include "solver/factor/direct_factor.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/bench/cholmod_factor.hpp"
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

/// An assembled system, as in the first step of a scene that falls.
struct Assembled {
  Scene scene;
  LinearSystem system;
  VectorX b;

  explicit Assembled(const SceneSpec& spec) : scene(build_scene(spec)), system(rod()) {
    Rod& falling = scene.rods.front();
    for (std::size_t s = 0; s < falling.segments.size(); ++s)
      if (!falling.segments[s].is_static) falling.position[s] += 0.02 * 0.02 * scene.gravity_m_s2;
    system.assemble(rod(), 0.02);
    b = VectorX::LinSpaced(system.matrix().unknowns(), -1, 2);
  }
  const Rod& rod() const { return scene.rods.front(); }
  double residual(const VectorX& x) const {
    VectorX product(x.size());
    system.matrix().multiply(x.data(), product.data());
    return (system.rhs() - product).norm() / system.rhs().norm();
  }
};

std::optional<CondensedFactor> condensed_factor(const Rod& rod) {
  if (!can_be_condensed(rod)) return {};
  Condensation condensation(rod);
  EliminationPlan plan = plan_crossings(condensation);
  return CondensedFactor(std::move(condensation), std::move(plan));
}

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
  DirectFactor factor(a.rod());
  for (auto _ : state)
    if (factor.solve(a.rod(), a.system, x) != SolveOutcome::converged) state.SkipWithError("a solve failed");
}

void whole(benchmark::State& state) {
  const Assembled a(scene_of(state));
  VectorX x = a.b;
  BlockFactor factor(a.system.matrix(), root_to_leaf_order(a.rod()));
  for (auto _ : state)
    if (factor.solve(a.system.matrix(), a.system.rhs(), x) != SolveOutcome::converged)
      state.SkipWithError("a solve failed");
}

void condensed(benchmark::State& state) {
  const Assembled a(scene_of(state));
  VectorX x = a.b;
  std::optional<CondensedFactor> factor = condensed_factor(a.rod());
  if (!factor) return state.SkipWithError("nearly inextensible");
  for (auto _ : state)
    if (!factor->solve(a.rod(), a.system, x)) state.SkipWithError("a solve failed");
}

void cholmod(benchmark::State& state) {
  const Assembled a(scene_of(state));
  VectorX x = a.b;
  bench::CholmodFactor factor(a.system.matrix());
  for (auto _ : state)
    if (!factor.solve(a.system.matrix(), a.system.rhs(), x)) state.SkipWithError("a solve failed");
  if (a.residual(x) > 1e-10) state.SkipWithError("an inaccurate solution");
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

const Cases costs{{"pattern", pattern},      {"plan", plan},     {"assembly", assembly},
                  {"product", product},      {"direct", direct}, {"learned", learned<false>},
                  {"lagging", learned<true>}};
const Cases direct_solves{{"whole", whole}, {"condensed", condensed}, {"cholmod", cholmod}};

void print_direct_solves(const Medians& median, std::size_t i) {
  const auto& [scene, spec] = scenes[i];
  const auto of = [&](const char* name) { return 1e3 * median(name, static_cast<std::int64_t>(i)); };
  std::printf("%-18s %10.3f %10.3f %10.3f %10.2f %10.2f", scene, of("whole"), of("condensed"), of("cholmod"),
              of("condensed") / of("whole"), of("cholmod") / of("whole"));
  const Assembled a(spec);
  VectorX x = a.b;
  BlockFactor factor(a.system.matrix(), root_to_leaf_order(a.rod()));
  factor.solve(a.system.matrix(), a.system.rhs(), x);
  std::printf(" %10.1e", a.residual(x));
  std::optional<CondensedFactor> condensed = condensed_factor(a.rod());
  const bool solved = condensed && condensed->solve(a.rod(), a.system, x);
  std::printf(" %10.1e %10s\n", solved ? a.residual(x) : 0, DirectFactor(a.rod()).condenses() ? "condensed" : "whole");
}

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
  std::printf(
      "\nDirect solves [ms], and over that of A; |b - A x| / |b| of each (0: nearly inextensible); what the method "
      "direct takes\n%-18s",
      "");
  for (const char* name : {"whole", "condensed", "cholmod", "condensed", "cholmod"}) std::printf(" %10s", name);
  std::printf(" %10s %10s %10s\n", "of whole", "condensed", "takes");
  for (std::size_t i = 0; i < scenes.size(); ++i) print_direct_solves(median, i);
}

}  // namespace

int main(int argc, char** argv) {
  for (const Cases& cases : {costs, direct_solves})
    for (std::size_t i = 0; i < scenes.size(); ++i) register_cases(cases, std::array{static_cast<std::int64_t>(i)});
  return run_benchmarks(argc, argv, print_summary);
}
