// CG ratios on recorded simulations equal those of a sweep.
#include <cmath>

#include "runner/dataset/dataset_reader.hpp"
#include "runner/measure/timed_guess.hpp"
#include "runner/training/validation_ratio.hpp"
#include "solver/guess/initial_guess.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_validation_ratio {

Json rods(const char* kind) {
  Json job = with("/kind", kind);
  job["samples"] = 3;
  job["scene"]["length_m"] = uniform(1, 4);
  job["guesses"] = {"zero", "quadratic", {{"subspace", {{"size", 3}}}}};
  return job;
}

TEST_CASE("the CG ratio of a guess on recorded simulations is that of a paired sweep") {
  const TemporaryFolder folder;
  for (const char* systems : {"first", "all"}) {
    Json data = without("/guesses", rods("\"dataset\""));
    data["record"] = {{"systems", systems}};
    const auto path = folder / (std::string(systems) + ".h5");
    make_data_set(path, data);
    const DatasetReader reader(path);
    const ValidationRatio ratios(reader.read(0, reader.size()));
    REQUIRE(ratios.simulations() == 3);

    const Plan sweep = plan_of(rods("\"sweep\""));
    for (const Task& task : sweep.tasks()) {
      const TaskRecord record = record_of(sweep, task.index);
      const TaskSpec spec = sweep.spec(task.index);
      for (std::size_t g = 0; g < 3; ++g) {
        CAPTURE(systems, task.index, g);
        const auto measured = ratios.measure(
            static_cast<std::size_t>(task.index),
            [&](const Scene& scene, const StoredSimulation&) { return make_guess(spec.guesses[g], spec, scene); });
        for (std::size_t t = 0; t < ValidationRatio::tolerance_count; ++t)
          CHECK(measured[t] == record.tasks.counted.cg_ratio[g * tolerance_ladder().size() + t]);
        if (g > 0) CHECK(measured[1] < 1);
      }
    }
  }
}

TEST_CASE("a guess that is no number saves nothing: its ratio is infinite") {
  struct NoNumber : ZeroGuess {
    Proposal propose(const LinearSystem&, const SolvePosition&, VectorX& x0) override {
      x0.setConstant(std::nan(""));
      return {true, 0};
    }
  };
  const TemporaryFolder folder;
  make_data_set(folder / "data.h5", data_job());
  const ValidationRatio ratios(DatasetReader(folder / "data.h5").read(0, 1));
  const auto infinite =
      ratios.measure(0, [](const Scene&, const StoredSimulation&) { return std::make_unique<NoNumber>(); });
  for (const double ratio : infinite) CHECK(std::isinf(ratio));
}

TEST_CASE("a rod at rest has no ratio") {
  Json job = data_job();
  job["scene"]["gravity_m_s2"] = {0, 0, 0};
  const TemporaryFolder folder;
  make_data_set(folder / "rest.h5", job);
  const ValidationRatio ratios(DatasetReader(folder / "rest.h5").read(0, 1));
  const auto none =
      ratios.measure(0, [](const Scene&, const StoredSimulation&) { return std::make_unique<ZeroGuess>(); });
  for (const double ratio : none) CHECK(std::isnan(ratio));
}

}  // namespace test_validation_ratio
}  // namespace rodsweep
