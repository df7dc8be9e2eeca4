// Which tasks of two jobs are the same, and in which keys the jobs differ.
#include <catch2/catch.hpp>

#include "runner/job/job_difference.hpp"
#include "runner/job/plan_matching.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace {

Json sweep_job() {
  Json job = with("/scene/segments", R"({"grid": [4, 6]})");
  job["scene"]["length_m"] = uniform(1, 3);
  job["samples"] = 3;
  job["guesses"] = Json::parse(R"(["zero", "previous", {"oracle": {"error": 0.1}}])");
  return job;
}

std::vector<std::pair<std::int64_t, std::int64_t>> numbers(const PlanMatch& match) {
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (const TaskPair& pair : match.pairs) pairs.emplace_back(pair.a, pair.b);
  return pairs;
}

using Numbers = std::vector<std::pair<std::int64_t, std::int64_t>>;

/// "solve.tolerance: 0.01, 0.001", a line for every key.
std::string differences(const Json& a, const Json& b) {
  std::string text;
  for (const KeyDifference& key : job_differences(job_of(a), job_of(b)))
    text += key.path + ": " + key.a.dump() + ", " + key.b.dump() + "\n";
  return text;
}

}  // namespace

TEST_CASE("sweeps with other grids, samples, guesses and records overlap in the tasks that both have") {
  Json other = sweep_job();
  other["name"] = "other";
  other["samples"] = 2;
  other["scene"]["segments"] = grid({9, 6});
  other["guesses"] = Json::parse(R"([{"oracle": {"error": 0.1, "label": "o"}}, "zero", "linear"])");
  other["record"] = {{"solves", "summary"}};
  const Plan a = plan_of(sweep_job()), b = plan_of(other);
  const PlanMatch found = match(a, b, MatchBy::everything);
  CHECK(numbers(found) == Numbers{{3, 2}, {4, 3}});  // six segments, samples 0 and 1
  CHECK(found.only_a == std::vector<std::int64_t>{0, 1, 2, 5});
  CHECK(found.only_b == std::vector<std::int64_t>{0, 1});
  for (const TaskPair& pair : found.pairs) CHECK(pair.guesses == std::vector<int>{1, -1, 0});
}

TEST_CASE("what differs on purpose keeps tasks apart, unless they are matched by what varies") {
  Json other = with("/solve", R"({"tolerance": 1e-3, "preconditioner": "icc"})", sweep_job());
  other["guesses"] = Json::parse(R"(["zero", {"pod": {"size": 3, "label": "previous"}}])");
  const Plan a = plan_of(sweep_job()), b = plan_of(other);
  CHECK(match(a, b, MatchBy::everything).pairs.empty());
  const PlanMatch found = match(a, b, MatchBy::parameters);
  CHECK(numbers(found) == Numbers{{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}});
  for (const TaskPair& pair : found.pairs) CHECK(pair.guesses == std::vector<int>{0, 1, -1});
  Json seeded = other;
  seeded["seed"] = 7;  // so the lengths are others
  CHECK(match(a, plan_of(seeded), MatchBy::parameters).pairs.empty());
  Json fixed = other;  // of a grid one value
  fixed["scene"]["segments"] = 6;
  CHECK(numbers(match(a, plan_of(fixed), MatchBy::parameters)) == Numbers{{3, 0}, {4, 1}, {5, 2}});
}

TEST_CASE("a closed loop's task is one guess's, and a guess that varies has a task for each") {
  Json closed = sweep_job();
  closed["evaluation"] = "closed_loop";
  Json other = closed;
  other["guesses"] = Json::parse(R"(["zero", {"oracle": {"error": 0.1}}])");
  const PlanMatch found = match(plan_of(closed), plan_of(other), MatchBy::everything);
  REQUIRE(found.pairs.size() == 12);
  CHECK(found.only_a.size() == 6);
  CHECK(found.pairs[0].guesses == std::vector<int>{0, -1, -1});
  CHECK(found.pairs[1].guesses == std::vector<int>{-1, -1, 1});
  CHECK(match(plan_of(closed), plan_of(other), MatchBy::parameters).pairs.size() == 12);

  Json varying = sweep_job(), more = sweep_job();
  varying["guesses"] = Json::parse(R"(["zero", {"oracle": {"error": {"grid": [0.1, 0.2]}, "label": "o"}}])");
  more["guesses"] = Json::parse(R"(["zero", {"oracle": {"error": {"grid": [0.3, 0.2, 0.1]}, "label": "o"}}])");
  for (const MatchBy by : {MatchBy::everything, MatchBy::parameters}) {
    const PlanMatch errors = match(plan_of(varying), plan_of(more), by);
    CHECK(errors.pairs.size() == 12);
    CHECK(errors.only_b.size() == 6);
    for (const TaskPair& pair : errors.pairs) CHECK(pair.guesses == std::vector<int>{0, 1});
  }
}

TEST_CASE("jobs differ in keys, in values of sweeps and in guesses by their label") {
  CHECK(differences(sweep_job(), sweep_job()) == "");
  Json other = with("/solve", R"({"tolerance": 1e-3})", sweep_job());
  other["name"] = "other";
  other["scene"]["segments"] = grid({4, 8});
  other["guesses"] = Json::parse(R"(["zero", {"oracle": {"error": 0.1}}, {"previous": {"label": "last"}}])");
  CHECK(differences(sweep_job(), other) ==
        "scene.segments: {\"grid\":[4,6]}, {\"grid\":[4,8]}\n"
        "guesses.previous: {\"previous\":{}}, null\n"
        "guesses.last: null, {\"previous\":{}}\n"
        "solve.tolerance: 0.01, 0.001\n");
  Job a = job_of(sweep_job()), b = a;
  a.files["net.h5"] = {"guesses[1].copingnet.model", "net.h5", "01"};
  b.files["net.h5"] = {"guesses[1].copingnet.model", "net.h5", "02"};
  REQUIRE(job_differences(a, b).size() == 1);
  CHECK(job_differences(a, b).front().a == "net.h5, hash 01");
}
