#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>

#include "runner/job/sobol.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_sobol {

std::vector<double> drawn(const Plan& plan, const std::string& path) {
  for (const ParameterColumn& column : plan.parameters()) {
    if (column.path == path) return std::get<ColumnValues<double>>(column.values).all();
  }
  FAIL("no column " + path);
  return {};
}

/// Two random keys in [0, 1].
Json job_with(const char* sampling, int samples, int seed = 0) {
  Json job = with("/sampling", fmt::format("\"{}\"", sampling));
  job["scene"]["initial_angle_deg"] = uniform(0, 1);
  job["scene"]["damping_per_s"] = uniform(0, 1);
  job["samples"] = samples;
  job["seed"] = seed;
  return job;
}

TEST_CASE("without a shift the points are Sobol's, with the direction numbers of Joe and Kuo") {
  // new-joe-kuo-6.21201, points 0 to 7, first four dimensions.
  const double known[8][4] = {{0, 0, 0, 0},
                              {0.5, 0.5, 0.5, 0.5},
                              {0.75, 0.25, 0.25, 0.25},
                              {0.25, 0.75, 0.75, 0.75},
                              {0.375, 0.375, 0.625, 0.875},
                              {0.875, 0.875, 0.125, 0.375},
                              {0.625, 0.125, 0.875, 0.625},
                              {0.125, 0.625, 0.375, 0.125}};
  const SobolSequence sobol(4);
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t d = 0; d < 4; ++d) CHECK(sobol.unit(d, i, 0) == known[i][d]);
}

TEST_CASE("a shift keeps one point in each of 2^k equal intervals, in every dimension") {
  constexpr std::size_t dimensions = 40, points = 256;
  const SobolSequence sobol(dimensions);
  for (std::size_t d = 0; d < dimensions; ++d) {
    std::vector<int> hits(points, 0);
    for (std::size_t i = 0; i < points; ++i)
      ++hits[static_cast<std::size_t>(sobol.unit(d, i, 0x9e3779b97f4a7c15u * (d + 1)) * points)];
    CHECK(std::count(hits.begin(), hits.end(), 1) == points);
  }
}

TEST_CASE("sobol draws depend on seed, sample and key path, not on the number of samples or the grid") {
  const auto few = drawn(plan_of(job_with("sobol", 5)), "scene.damping_per_s");
  const auto many = drawn(plan_of(job_with("sobol", 50)), "scene.damping_per_s");
  CHECK(std::equal(few.begin(), few.end(), many.begin()));
  CHECK(drawn(plan_of(job_with("sobol", 5, 1)), "scene.damping_per_s") != few);
  CHECK(drawn(plan_of(job_with("sobol", 5)), "scene.initial_angle_deg") != few);

  Json job = job_with("sobol", 3);
  job["scene"]["segments"] = grid({4, 5});
  const auto both = drawn(plan_of(job), "scene.damping_per_s");
  REQUIRE(both.size() == 6);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(both[k] == few[k]);
    CHECK(both[k + 3] == few[k]);
  }
}

TEST_CASE("logarithmic and whole draws and components of vectors are Sobol's too") {
  Json job = job_with("sobol", 64);
  job["scene"]["youngs_modulus_pa"] = {{"log_uniform", {1e4, 1e6}}};
  job["scene"]["segments"] = {{"integer", {3, 6}}};
  job["scene"]["tip_force_n"] = {uniform(0, 1), uniform(0, 1), 0};
  const Plan plan = plan_of(job);
  const auto moduli = drawn(plan, "scene.youngs_modulus_pa"), forces = drawn(plan, "scene.tip_force_n");
  CHECK(std::count_if(moduli.begin(), moduli.end(), [](double y) { return y < 1e5; }) == 32);
  int of_three = 0, low_x = 0, low_both = 0;
  for (std::size_t k = 0; k < 64; ++k) {
    of_three += plan.task(static_cast<std::int64_t>(k)).segments == 3;
    low_x += forces[3 * k] < 0.5;
    low_both += forces[3 * k] < 0.5 && forces[3 * k + 1] < 0.5;
  }
  CHECK(of_three == 16);
  CHECK(low_x == 32);
  CHECK(low_both == 16);
}

TEST_CASE("more random values than Sobol's sequence has dimensions are refused") {
  Json job = job_with("sobol", 2);
  const auto most = static_cast<int>(SobolSequence::most_dimensions());
  for (int i = 0; i < most - 1; ++i)
    job["guesses"].push_back({{"oracle", {{"error", uniform(0, 1)}, {"label", fmt::format("{}", i)}}}});
  CHECK(refusal(job) == fmt::format("job.json: sampling: \"sobol\" is not allowed: this job draws {} values per "
                                    "sample, and the Sobol sequence has at most {} dimensions; use \"random\"",
                                    most + 1, most));
  CHECK(refusal(with("/sampling", "\"sobel\"")) ==
        "job.json: sampling: \"sobel\" is not allowed; must be one of \"random\", \"sobol\"; did you mean \"sobol\"?");
}

}  // namespace test_sobol
