// Every preconditioner of CG and every method of projection on every kind of graph: solves that are said to converge do,
// no solve misses its tolerance, and rods move as with the direct solve. A preconditioner that is not positive definite
// is found out. A word of a job without a sample here fails.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "runner/plan/plan.hpp"
#include "runner/specs/solve_keys.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep::test_every_preconditioner {

constexpr const char* python_diagonal = R"(
class Preconditioner:
    def __init__(self, rods, options): pass
    def set_up(self, system): self.inverse = 1 / system.A.diagonal()
    def apply(self, r): return self.inverse * r
)";

class Graphs {
 public:
  Graphs() {
    std::ofstream(folder_ / "diagonal.py") << python_diagonal;
    add("chain", R"({"type": "bending_rod", "segments": 10, "length_m": 1})");
    add("tree", R"({"type": "tree", "depth": 2, "branches": 2, "segments": 3, "length_m": 1})");
    add("loop", R"({"type": "ring", "segments": 12, "length_m": 2})");
    add("net", R"({"type": "net", "rows": 3, "columns": 3, "segments": 2, "mesh_m": 0.4})");
    add("lattice", R"({"type": "lattice", "nodes_x": 2, "segments": 3, "mesh_m": 0.4})");
    add("rods of unequal length", two_rods(path("rods.csv")));
  }
  std::string path(const std::string& name) const { return (folder_ / name).native(); }
  const std::map<std::string, Json>& scenes() const { return scenes_; }
  Json job(const Json& scene, const Json& solve, const char* evaluation) const {
    return {{"name", "law"},
            {"kind", "sweep"},
            {"scene", scene},
            {"evaluation", evaluation},
            {"time", {{"step_s", 0.02}, {"steps", 3}, {"newton_iterations", 3}}},
            {"solve", solve},
            {"guesses", {"zero", "previous"}}};
  }

 private:
  void add(const char* name, const char* scene) { add(name, Json::parse(scene)); }
  void add(const char* name, const Json& scene) {
    scenes_[name] = scene;
    scenes_[name].update(
        {{"radius_m", 0.02}, {"density_kg_m3", 1000}, {"youngs_modulus_pa", 1e7}, {"torsion_modulus_pa", 4e6}});
  }

  TemporaryFolder folder_;
  std::map<std::string, Json> scenes_;
};

std::vector<std::string> words(const char* key) {
  static const Key solve = solve_key();
  return find_key(solve.keys, key)->choices;
}

/// The sample of a preconditioner for a scene.
Json solve_by(const std::string& preconditioner, const std::string& graph, [[maybe_unused]] const Graphs& graphs) {
  const bool loops = graph == "loop" || graph == "net" || graph == "lattice";
  const std::map<std::string, Json> files{
      {"learned", {{"model", loops ? PRETRAINED "/lattices.h5" : PRETRAINED "/rods.h5"}}},
      {"plugin", {{"library", WATCHING_PLUGIN}}},
#ifdef HAS_PYTHON
      {"python", {{"file", graphs.path("diagonal.py")}}},
#endif
  };
  Json solve{{"method", "cg"}, {"preconditioner", preconditioner}, {"tolerance", 1e-6}};
  if (const auto file = files.find(preconditioner); file != files.end())
    solve[preconditioner + "_preconditioner"] = file->second;
  return solve;
}

/// Solves of all guesses that missed tolerances down to 1e-6, and of those that were not said to converge.
int missed(const TaskRecord& record) {
  const std::vector<double>& ladder = tolerance_ladder();
  const auto most = static_cast<std::size_t>(
      std::count_if(ladder.begin(), ladder.end(), [](double tolerance) { return tolerance > 0.9e-6; }));
  int count = 0;
  for (const CountSums* sums : {&record.tasks.counted_all, &record.tasks.counted_other_norm})
    for (std::size_t g = 0; g < 2; ++g)
      for (std::size_t t = 0; t < most; ++t) count += std::max(sums->unreached(0, g, t), 0);
  return count;
}

/// The largest true residual of a solve that is said to have converged, relative to ||b||.
double worst_converged(const TaskRecord& record) {
  double worst = 0;
  for (std::size_t i = 0; i < record.solves.outcome.size(); ++i)
    if (record.solves.outcome[i] == static_cast<std::int8_t>(SolveOutcome::converged))
      worst = std::max(worst, record.solves.final_residual[i]);
  return worst;
}

int converged(const TaskRecord& record) {
  return static_cast<int>(std::count(record.solves.outcome.begin(), record.solves.outcome.end(),
                                     static_cast<std::int8_t>(SolveOutcome::converged)));
}

TEST_CASE("every preconditioner solves every kind of graph, and residuals are what they are said to be") {
  const Graphs graphs;
  for (const std::string& preconditioner : words("preconditioner")) {
#ifndef HAS_PYTHON
    if (preconditioner == "python") continue;
#endif
    for (const auto& [name, scene] : graphs.scenes()) {
      CAPTURE(preconditioner, name);
      const Json solve = solve_by(preconditioner, name, graphs);
      const TaskRecord paired = record_of(graphs.job(scene, solve, "paired"));
      INFO(paired.message);
      REQUIRE(paired.outcome == TaskOutcome::ok);
      CHECK(missed(paired) == 0);
      CHECK(converged(paired) > 10);
      CHECK(worst_converged(paired) <= 1.1e-8);

      const TaskRecord closed = record_of(graphs.job(scene, solve, "closed_loop"));
      const TaskRecord direct =
          record_of(without("/guesses", graphs.job(scene, {{"method", "direct"}}, "closed_loop")));
      INFO(closed.message);
      REQUIRE(closed.outcome == TaskOutcome::ok);
      CHECK(closed.steps.kinetic_energy_j.back() == Approx(direct.steps.kinetic_energy_j.back()).epsilon(1e-3));
      CHECK(closed.steps.potential_energy_j.back() == Approx(direct.steps.potential_energy_j.back()).epsilon(1e-3));
    }
  }
}

TEST_CASE("every method moves every kind of graph, or says how it failed") {
  const Graphs graphs;
  const std::map<std::string, Json> samples{
      {"cg", {{"tolerance", 1e-6}}},
      {"direct", Json::object()},
      {"end_to_end", {{"model", PRETRAINED "/rods.h5"}}},
      {"state_network", {{"model", PRETRAINED "/bending-state.h5"}}},
      {"xpbd", {{"iterations", 50}}},
      {"pbd", {{"iterations", 50}}},
  };
  for (const std::string& method : words("method")) {
    CAPTURE(method);
    REQUIRE(samples.count(method) == 1);
    for (const auto& [name, scene] : graphs.scenes()) {
      CAPTURE(name);
      Json solve = samples.at(method);
      solve["method"] = method;
      Json job = graphs.job(scene, solve, "closed_loop");
      if (method != "cg") job.erase("guesses");
      const Plan plan = plan_of(job);
      const TaskRecord record = record_of(plan, 0);
      INFO(record.message);
      const auto done = static_cast<std::size_t>(record.tasks.steps_done[0]);
      REQUIRE(done > 0);
      if (is_network(plan.spec(0).solve.method) && record.outcome != TaskOutcome::ok) {  // never trained on this
        CHECK((record.outcome == TaskOutcome::torn || record.outcome == TaskOutcome::diverged));
        CHECK(record.steps.joint_gap[done - 1] > 1);
        continue;
      }
      CHECK(record.outcome == TaskOutcome::ok);
      CHECK(done == 3);
      CHECK(record.steps.kinetic_energy_j.back() > 0);
      CHECK(record.steps.joint_gap.back() < 0.5);
    }
  }
}

TEST_CASE("what converged with a preconditioner that is not positive definite did so, on any graph, in any norm") {
  const Graphs graphs;
  for (const char* wrong : {"first", "nothing", "every other", "negative"})
    for (const char* norm : {"true_residual", "natural"})
      for (const auto& [name, scene] : graphs.scenes()) {
        CAPTURE(wrong, norm, name);
        Json solve{
            {"method", "cg"},        {"preconditioner", "plugin"},
            {"tolerance", 1e-2},     {"norm", norm},
            {"max_iterations", 300}, {"plugin_preconditioner", {{"library", WATCHING_PLUGIN}, {"options", wrong}}}};
        const TaskRecord paired = record_of(graphs.job(scene, solve, "paired"));
        CHECK(worst_converged(paired) <= (norm == std::string("natural") ? 1e-5 : 1.1e-8));
        if (wrong == std::string("negative")) continue;  // CG may converge all the same
        const TaskRecord closed = record_of(graphs.job(scene, solve, "closed_loop"));
        INFO(closed.message);
        CHECK((closed.outcome == TaskOutcome::indefinite || closed.outcome == TaskOutcome::iteration_limit));
      }
}

}  // namespace rodsweep::test_every_preconditioner
