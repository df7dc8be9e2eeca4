// Tasks that start from a frame of another simulation, and tasks that end at rest.
#include <cmath>

#include "runner/measure/plan_check.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_start_and_rest {

using Catch::Matchers::ContainsSubstring;

Json with_states() {
  Json job = five_steps(R"(["zero"])");
  job["record"] = {{"trajectory_every", 2}, {"states", true}};
  return job;
}

Json started(const Json& start) {
  Json job = with_states();
  job["start"] = start;
  return job;
}

Plan plan_in(const TemporaryFolder& folder, const Json& job) {
  return Plan(parse_job(job.dump(), folder / "job.json"));
}

TEST_CASE("a task starts from the last frame of a file, or from one at a time, with its clock or another") {
  const TemporaryFolder folder;
  const Plan whole = make_data_set(folder / "a.h5", with_states());
  const TaskRecord first = record_of(whole);
  const auto frame_0 = [&](const Json& start) { return record_of(plan_in(folder, started(start))); };
  const TaskRecord last = frame_0({{"file", "a.h5"}}), earlier = frame_0({{"file", "a.h5"}, {"time_s", 0.04}}),
                   again = frame_0({{"file", "a.h5"}, {"clock_s", 7}});
  CHECK(last.outcome == TaskOutcome::ok);
  CHECK(last.trajectories.time_s[0] == Approx(0.08));
  CHECK(earlier.trajectories.time_s[0] == Approx(0.04));
  CHECK(again.trajectories.time_s[0] == 7);
  CHECK(again.steps.time_s[0] == Approx(7.02));
  const auto n = static_cast<std::size_t>(whole.task(0).segments);
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(last.trajectories.position_m(s, i) == first.trajectories.position_m(2 * n + s, i));
      CHECK(last.trajectories.states.velocity_m_s(s, i) == first.trajectories.states.velocity_m_s(2 * n + s, i));
      CHECK(earlier.trajectories.position_m(n + s, i) == first.trajectories.position_m(2 * n + s, i));
    }
}

TEST_CASE("a task starts from one that has fewer frames than others of its file") {
  const TemporaryFolder folder;
  Json job = with_states();
  job["time"]["steps"] = {{"grid", {4, 40}}};
  make_data_set(folder / "a.h5", job);
  const TaskRecord from = record_of(plan_of(job));
  const TaskRecord record = record_of(plan_in(folder, started({{"file", "a.h5"}})));
  REQUIRE(record.outcome == TaskOutcome::ok);
  const auto& lambda = from.trajectories.states.lambda;
  const std::size_t joints = lambda.size() / 6 / 3;
  for (std::size_t joint = 0; joint < joints; ++joint)
    CHECK(record.trajectories.states.lambda(joint, 4) == lambda(2 * joints + joint, 4));
}

TEST_CASE("a start that does not fit is refused with file, task and what to do") {
  const TemporaryFolder folder;
  Json several = with_states();
  several["scene"]["youngs_modulus_pa"] = {{"grid", {1e5, 2e5}}};
  make_data_set(folder / "a.h5", several, 1);
  make_data_set(folder / "plain.h5", five_steps(R"(["zero"])"));
  const auto refusal = [&](const Json& job) {
    return message_of<JobError>([&] { checked_plan(plan_in(folder, job).job()); });
  };
  CHECK(refusal(started({{"file", "a.h5"}})).empty());
  CHECK_THAT(refusal(started({{"file", "plain.h5"}})),
             ContainsSubstring("start.file: task 0 of ") &&
                 ContainsSubstring(
                     "has no states; run its job with \"record\": {\"trajectory_every\": ..., \"states\": true}"));
  CHECK_THAT(refusal(started({{"file", "a.h5"}, {"task", 99}})), ContainsSubstring("has no task 99: it has "));
  CHECK_THAT(refusal(started({{"file", "a.h5"}, {"task", 1}})), ContainsSubstring("is not ok but "));
  CHECK_THAT(refusal(started({{"file", "a.h5"}, {"time_s", 0.05}})),
             ContainsSubstring("has no frame at 0.05 s; the nearest is at 0.0"));
  Json longer = started({{"file", "a.h5"}});
  longer["scene"]["length_m"] = 3;
  CHECK_THAT(refusal(longer), ContainsSubstring("has other segments than this scene, from segment 0 on"));
  Json finer = started({{"file", "a.h5"}});
  finer["scene"]["segments"] = 40;
  CHECK_THAT(refusal(finer), ContainsSubstring("has other segments than this scene"));
}

TEST_CASE("a task ends at rest, keeps the shape as its last frame, and says if it is not at rest") {
  Json job = with_states();
  job["time"] = {{"step_s", 0.02}, {"steps", 2001}, {"until", {{"rest", 1e-6}}}};
  job["record"]["trajectory_every"] = 1000;
  const TaskRecord rest = record_of(job);
  CHECK(rest.outcome == TaskOutcome::ok);
  CHECK(rest.message.empty());
  const int done = rest.tasks.steps_done[0];
  CHECK(done > 5);
  CHECK(done < 1000);
  CHECK(rest.trajectories.first_row[1] > 0);
  CHECK(rest.trajectories.time_s[1] == Approx(0.02 * done));
  CHECK(rest.trajectories.first_row[2] == -1);
  CHECK(std::isnan(rest.steps.time_s[static_cast<std::size_t>(done)]));
  CHECK(rest.steps.momentum_residual[static_cast<std::size_t>(done) - 1] < 1e-6);

  job["time"]["steps"] = 5;
  const TaskRecord early = record_of(job);
  CHECK(early.tasks.steps_done[0] == 5);
  CHECK_THAT(early.message, ContainsSubstring("not at rest: a segment lacks") && ContainsSubstring("use more steps"));
}

}  // namespace test_start_and_rest
}  // namespace rodsweep
