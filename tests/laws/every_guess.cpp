// Every guess that jobs can name, alone and within every guess that uses another: what it proposes depends on nothing but
// the systems and solutions that it was given. So counts do not depend on repeats, on what is recorded, on other guesses
// or on the order of tasks. A guess without a sample here does not compile.
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "runner/measure/timed_guess.hpp"
#include "runner/plan/plan.hpp"
#include "solver/cg/cg_solver.hpp"
#include "solver/linear/solve_outcome.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_every_guess {

/// Two rods of unequal length, and the files that guesses need.
class Files {
 public:
  Files() {
    scene_ = two_rods(path("rods.csv"));
    Json data = job({});
    data.erase("guesses");
    data["kind"] = "dataset";
    make_data_set(path("data.h5"), data);
  }
  std::string path(const std::string& name) const { return (folder_ / name).native(); }
  Json job(const Json& guesses, const Json& changes = Json::object()) const {
    Json made{{"name", "law"},
              {"kind", "sweep"},
              {"scene", scene_},
              {"time", {{"step_s", 0.02}, {"steps", 5}, {"newton_iterations", 2}}},
              {"guesses", guesses}};
    made.update(changes, true);
    return made;
  }

 private:
  TemporaryFolder folder_;
  Json scene_;
};

// The samples, found by the kind of guess.
using Samples = std::vector<Json>;

Json of(const char* name, const Json& parameters) {
  Json made;
  made[name] = parameters;
  return made;
}
const Json watching = of("plugin", {{"library", WATCHING_PLUGIN}});

Samples samples(const guess::Zero&, const Files&) { return {Json("zero")}; }
Samples samples(const guess::Previous&, const Files&) { return {Json("previous")}; }
Samples samples(const guess::Linear&, const Files&) { return {Json("linear")}; }
Samples samples(const guess::Quadratic&, const Files&) { return {Json("quadratic")}; }
Samples samples(const guess::Fischer&, const Files&) { return {of("fischer", {{"size", 2}})}; }
Samples samples(const guess::Subspace&, const Files&) { return {of("subspace", {{"size", 3}})}; }
Samples samples(const guess::Deflation&, const Files&) { return {of("deflation", {{"size", 3}})}; }
Samples samples(const guess::Regression&, const Files&) { return {of("regression", {{"size", 3}})}; }
Samples samples(const guess::CopingNet&, const Files&) {
  const Json lagged{{"model", PRETRAINED "/rods.h5"}, {"corrections", 3}, {"lag_steps", 2}};
  return {of("copingnet", {{"model", PRETRAINED "/bending-paper.h5"}}), of("copingnet", lagged)};
}
Samples samples(const guess::Knn&, const Files& files) {
  return {of("knn", {{"data", files.path("data.h5")}, {"k", 2}})};
}
Samples samples(const guess::Plugin&, const Files&) { return {watching}; }
Samples samples(const guess::Python&, const Files&) {
#ifdef HAS_PYTHON
  return {of("python", {{"file", PYTHON_GUESS}})};
#else
  return {};
#endif
}
Samples samples(const guess::Oracle&, const Files&) { return {of("oracle", {{"error", 0.1}})}; }
/// The keys of a guess beside the one that it uses.
Json parameters(const guess::Guarded&) { return {{"threshold", 0.5}}; }
Json parameters(const guess::Totals&) { return Json::object(); }
Json parameters(const guess::First&) { return Json::object(); }
Json parameters(const guess::Ritz&) { return {{"size", 4}, {"collected", 6}, {"lag_steps", 2}}; }

template <class Kind>
constexpr bool uses_another = std::is_base_of_v<guess::OfAnother, Kind>;

template <class Call, std::size_t... i>
void for_each_kind(const Call& call, std::index_sequence<i...>) {
  (call(std::variant_alternative_t<i, GuessKind>{}), ...);
}
template <class Call>
void for_each_kind(const Call& call) {
  for_each_kind(call, std::make_index_sequence<std::variant_size_v<GuessKind>>{});
}

Samples guesses_alone(const Files& files) {
  Samples all;
  for_each_kind([&](const auto& kind) {
    if constexpr (!uses_another<std::decay_t<decltype(kind)>>)
      for (const Json& sample : samples(kind, files)) all.push_back(sample);
  });
  return all;
}

/// A guess within each guess that uses another.
Samples around(const Json& inner) {
  Samples all;
  for_each_kind([&](const auto& kind) {
    using Kind = std::decay_t<decltype(kind)>;
    if constexpr (uses_another<Kind>) {
      Json keys = parameters(kind);
      keys["guess"] = inner;
      all.push_back(of(Kind::name, keys));
    }
  });
  return all;
}

/// All guesses alone, each within every other, and one twice within.
Samples all_guesses(const Files& files) {
  const Samples alone = guesses_alone(files);
  Samples all = alone;
  for (const Json& inner : alone)
    for (Json& outer : around(inner)) all.push_back(std::move(outer));
  for (const Json& inner : around(watching))
    for (Json& outer : around(inner)) all.push_back(std::move(outer));
  return all;
}

/// A guess, and the solver of each rod.
class Tried {
 public:
  Tried(const GuessSpec& spec, const TaskSpec& task, const Scene& scene)
      : label(spec.label), guess(make_guess(spec, task, scene)), solvers_(scene.rods.size()) {}

  /// The iterations of a solve from x, which becomes the solution.
  int solve(const Scene& scene, const LinearSystem& system, const SolvePosition& at, const Proposal& proposal,
            double tolerance, VectorX& x) {
    auto& solver = solvers_[static_cast<std::size_t>(at.rod)];
    if (!solver) solver = make_cg(scene.rods[static_cast<std::size_t>(at.rod)], system, {});
    solver->matrix_changed();
    const CgReport report =
        solver->solve(system.rhs(), x, proposal.start(), tolerance, system.rhs().norm(), guess->deflation());
    CHECK(report.outcome == SolveOutcome::converged);
    return report.iterations;
  }

  std::string label;
  std::unique_ptr<InitialGuess> guess;

 private:
  std::vector<std::unique_ptr<CgSolver>> solvers_;
};

TEST_CASE("every guess answers the same when asked again, whatever solves start from its answers") {
  const Files files;
  const Plan plan = plan_of(files.job(all_guesses(files)));
  const TaskSpec task = plan.spec(0);
  Scene scene = build_scene(task.scene);
  REQUIRE(scene.rods.size() == 2);
  REQUIRE(scene.rods[0].joint_count() != scene.rods[1].joint_count());
  std::vector<std::pair<Tried, Tried>> pairs;
  for (const GuessSpec& spec : task.guesses) pairs.emplace_back(Tried(spec, task, scene), Tried(spec, task, scene));
  REQUIRE(pairs.size() > 4 * std::variant_size_v<GuessKind>);

  observe(scene, {0.02, 2, 0}, 5, [&](const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
    if (system.largest_rhs() <= rounding_level) return;
    const double size = system.rhs().norm();
    for (auto& [once, often] : pairs) {
      CAPTURE(once.label, at.step, at.newton, at.rod);
      VectorX expected = VectorX::Zero(solution.size()), x0 = expected, x = expected;
      once.guess->prepare(at);
      often.guess->prepare(at);
      const Proposal first = once.guess->propose(system, at, expected);
      for (const double tolerance : {1e-8, 1e-2, 1e-4}) {
        const Proposal again = often.guess->propose(system, at, x0);
        CHECK(x0 == expected);
        CHECK(again.nonzero == first.nonzero);
        CHECK(again.start_products() == first.start_products());
        if (again.residual) {
          system.multiply(x0.data(), x.data());
          CHECK((system.rhs() - x - *again.residual).norm() <= 1e-9 * (size + again.residual->norm()));
        }
        x = x0;
        often.solve(scene, system, at, again, tolerance, x);
      }
      x = expected;
      const int iterations = once.solve(scene, system, at, first, 1e-2, x);
      const Proposal last = often.guess->propose(system, at, x0);
      CHECK(often.solve(scene, system, at, last, 1e-2, x0) == iterations);
      CHECK(x0 == x);
      once.guess->accept(system, at, solution);
      often.guess->accept(system, at, solution);
    }
  });
}

using Counts = std::map<std::string, std::vector<std::int64_t>>;

void append(std::vector<std::int64_t>& to, const std::vector<std::int64_t>& sums, std::size_t guess,
            std::size_t guesses) {
  const std::size_t of_a_guess = sums.size() / guesses;
  to.insert(to.end(), sums.begin() + static_cast<std::ptrdiff_t>(guess * of_a_guess),
            sums.begin() + static_cast<std::ptrdiff_t>((guess + 1) * of_a_guess));
}

/// Iterations and products by guess and task, of the tasks in this order.
Counts counts_of(const Json& job, bool backwards = false) {
  const Plan plan = plan_of(job);
  Counts counts;
  const std::vector<std::string> labels = plan.guess_labels();
  for (std::int64_t i = 0; i < plan.size(); ++i) {
    const std::int64_t index = backwards ? plan.size() - 1 - i : i;
    const TaskRecord record = record_of(plan, index);
    INFO(record.message);
    CHECK(record.outcome == TaskOutcome::ok);
    CHECK_THAT(record.message, !Catch::Matchers::ContainsSubstring("guess"));
    for (std::size_t g = 0; g < labels.size(); ++g) {
      if (record.tasks.counted.iterations(0, g) < 0) continue;
      std::vector<std::int64_t>& own = counts[labels[g]];
      append(own, record.tasks.counted_all.iterations, g, labels.size());
      append(own, record.tasks.counted_all.matvecs, g, labels.size());
      append(own, record.tasks.counted.iterations, g, labels.size());
    }
  }
  return counts;
}

TEST_CASE("every guess takes the same iterations, whatever is repeated, recorded or tried beside it") {
  const Files files;
  Samples guesses = guesses_alone(files);
  for (const Json& inner : {Json("previous"), watching})
    for (Json& outer : around(inner)) guesses.push_back(std::move(outer));
  for (const char* evaluation : {"paired", "closed_loop"}) {
    CAPTURE(evaluation);
    const Json closed{{"evaluation", evaluation}, {"solve", {{"method", "cg"}}}};
    const auto with = [&](Json changes) {
      Json all = closed;
      all.update(changes, true);
      return counts_of(files.job(guesses, all));
    };
    const Counts expected = with(Json::object());
    REQUIRE(expected.size() == guesses.size());
    CHECK(with({{"solve", {{"timing_repeats", 3}}}}) == expected);
    CHECK(with({{"record", {{"norms", "one"}}}}) == expected);
    CHECK(with({{"record", {{"solves", "summary"}}}}) == expected);
    CHECK(with({{"record", {{"trajectory_every", 1}}}}) == expected);
    CHECK(counts_of(files.job(guesses, closed), true) == expected);

    Samples reversed = guesses;
    std::reverse(reversed.begin(), reversed.end());
    CHECK(counts_of(files.job(reversed, closed)) == expected);
    for (const Json& guess : guesses) {
      const Samples few = guess == "zero" ? Samples{guess} : Samples{Json("zero"), guess};
      for (const auto& [label, counts] : counts_of(files.job(few, closed))) {
        CAPTURE(label);
        CHECK(counts == expected.at(label));
      }
    }
  }
}

TEST_CASE("every guess moves the rods alike where nothing is counted, and says for how many solves a network ran") {
  const Files files;
  Samples guesses = guesses_alone(files);
  for (const char* model : {"/bending-paper.h5", "/rods.h5"})
    for (Json& outer : around(of("copingnet", {{"model", PRETRAINED + std::string(model)}})))
      guesses.push_back(std::move(outer));
  const Json closed{{"evaluation", "closed_loop"}, {"solve", {{"method", "cg"}}}};
  Json timed = closed;
  timed["record"] = {{"norms", "none"}, {"solves", "summary"}};
  const Plan plan = plan_of(files.job(guesses, closed)), plan_timed = plan_of(files.job(guesses, timed));
  CHECK(plan_of(files.job({"previous"}, timed)).size() == 1);  // without ratios, and so without "zero"
  for (std::int64_t index = 0; index < plan.size(); ++index) {
    const std::string label = plan.guess_labels()[static_cast<std::size_t>(index)];
    CAPTURE(label);
    const TaskRecord counted = record_of(plan, index), alone = record_of(plan_timed, index);
    CHECK(alone.steps.products == counted.steps.products);
    CHECK(alone.steps.kinetic_energy_j == counted.steps.kinetic_energy_j);
    CHECK((plan.spec(index).solves_directly() && !plan_timed.spec(index).solves_directly()));
    CHECK(alone.timing.steps_processor_s[0] > 0);
    CHECK(alone.timing.steps_processor_s[0] < counted.timing.elapsed_s[0] + alone.timing.elapsed_s[0]);
    const auto own = static_cast<std::size_t>(index);
    const auto solves = alone.timing.solves_timed(0, own), with = alone.timing.solves_with_network(0, own);
    CHECK(with == counted.timing.solves_with_network(0, own));
    const auto has = [&](const char* word) { return label.find(word) != std::string::npos; };
    if (!has("copingnet"))
      CHECK(with == 0);
    else if ((has("lag") && !has("ritz")) || has("first"))  // two steps a prediction, or one of two Newton iterations
      CHECK((with > 0 && with < solves));
    else
      CHECK(with == solves);
  }
}

TEST_CASE("every guess that uses another passes on each system with its solution, and totals their sum") {
  const Files files;
  Samples guesses{Json("zero"), watching};
  for (const Json& inner : around(watching)) {
    guesses.push_back(inner);
    for (Json& outer : around(inner)) guesses.push_back(std::move(outer));
  }
  const Json summing = of("plugin", {{"library", WATCHING_PLUGIN}, {"options", "sums"}});
  guesses.push_back(of("totals", {{"guess", summing}}));
  for (const char* evaluation : {"paired", "closed_loop"})
    for (const int newton : {1, 3}) {
      CAPTURE(evaluation, newton);
      // An error of the watching guess is the outcome of its task.
      counts_of(files.job(guesses, {{"evaluation", evaluation},
                                    {"solve", {{"method", "cg"}, {"timing_repeats", 2}}},
                                    {"time", {{"newton_iterations", newton}}}}));
    }
}

}  // namespace rodsweep::test_every_guess
