
#include "runner/file/extension.hpp"
#include "runner/plan/plan.hpp"
#include "tests/catch.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::EndsWith, Catch::Matchers::StartsWith;

namespace test_extension {

/// The error message for `job` as an extension of `before`, up to its advice; "" if it is valid.
std::string objection(const Json& job, const Json& before) {
  const std::string text = message_of<JobError>(
      [&] { check_extends(parse_job(job.dump(), "new.json"), parse_job(before.dump(), "old.h5")); });
  return text.substr(0, text.find(". --extend allows these changes to the job of old.h5"));
}

Json two_grids() {
  Json job = with("/scene/segments", R"({"grid": [4, 5]})");
  job["samples"] = 2;
  job["scene"]["length_m"] = uniform(1, 2);
  job["solve"] = {{"preconditioner", zip({"none", "icc"})}, {"tolerance", zip({1e-1, 1e-2})}};
  job["guesses"] = Json::parse(R"(["zero", {"oracle": {"error": {"grid": [0.1, 0.2]}}}])");
  return job;
}

TEST_CASE("more samples and more values extend a job, in any order and under other names") {
  const Json before = two_grids();
  CHECK(objection(before, before) == "");
  Json job = before;
  job["name"] = "other";
  job["description"] = "larger";
  job["samples"] = 3;
  job["scene"]["segments"] = grid({7, 5, 4});
  job["scene"]["radius_m"] = grid({0.01, 0.05});
  job["solve"] = {{"preconditioner", zip({"jacobi", "none", "icc"})}, {"tolerance", zip({1, 1e-1, 1e-2})}};
  job["guesses"] =
      Json::parse(R"([{"zero": {"label": "none"}}, {"oracle": {"error": {"grid": [0.3, 0.2, 0.1]}, "label": "o"}}])");
  CHECK(objection(job, before) == "");

  Json scenes = small_job();
  scenes["scene"] = grid({helix_scene(), bending_scene()});
  CHECK(objection(scenes, small_job()) == "");
  Json guesses = small_job();
  guesses["guesses"] = Json::parse(R"(["zero", {"grid": ["linear", "previous"]}])");
  CHECK(objection(guesses, small_job()) == "");
}

TEST_CASE("a job that is no extension of another is refused with the first key that differs") {
  const Json before = two_grids();
  const auto changed = [&](const std::string& pointer, const std::string& value) {
    return objection(with(pointer, value, before), before);
  };
  CHECK(changed("/seed", "6") == "new.json: seed: 6 here, 0 in old.h5");
  CHECK(changed("/sampling", "\"sobol\"") == "new.json: sampling: \"sobol\" here, \"random\" in old.h5");
  CHECK(changed("/samples", "1") == "new.json: samples: 1 here are fewer than the 2 in old.h5");
  CHECK(changed("/scene/segments", R"({"grid": [4, 6]})") ==
        "new.json: scene.segments: {\"grid\":[4,6]} here, 5 in old.h5");
  CHECK(changed("/scene/segments", "4") == "new.json: scene.segments: 4 here, {\"grid\":[4,5]} in old.h5");
  CHECK(changed("/scene/length_m", R"({"uniform": [1, 3]})") ==
        "new.json: scene.length_m: {\"uniform\":[1,3]} here, {\"uniform\":[1.0,2.0]} in old.h5");
  CHECK(changed("/scene/tip_force_n", "[0, 1, 0]") == "new.json: scene.tip_force_n[1]: 1 here, 0 in old.h5");
  CHECK(changed("/time/step_s", "0.01") == "new.json: time.step_s: 0.01 here, 0.02 in old.h5");
  CHECK(changed("/record", R"({"solves": "summary"})") ==
        "new.json: record.solves: \"summary\" here, \"all\" in old.h5");
  CHECK(changed("/guesses/1/oracle/error", "0.1") ==
        "new.json: guesses[1].oracle.error: 0.1 here, {\"grid\":[0.1,0.2]} in old.h5");
  Json more = small_job();
  more["guesses"].push_back("linear");
  CHECK_THAT(objection(more, small_job()), StartsWith("new.json: guesses: [") && EndsWith(" in old.h5"));
  const std::string text = message_of<JobError>(
      [&] { check_extends(parse_job(more.dump(), "new.json"), parse_job(small_job().dump(), "old.h5")); });
  CHECK_THAT(text, EndsWith("to compare other guesses, run this job without --extend, so that one run times them all"));
  Json duration = without("/time/steps", before);
  duration["time"]["duration_s"] = 0.2;
  CHECK(objection(duration, before) == "new.json: time.steps: nothing here, 10 in old.h5");
}

TEST_CASE("a task is the same in another plan only where all that its results depend on is") {
  Json large = full_job();
  large["samples"] = 3;
  large["scene"]["segments"] = grid({7, 9, 5, 4});
  large["guesses"] = Json::parse(R"(["zero", {"previous": {"label": "p"}}])");
  const Plan small = plan_of(full_job()), more = plan_of(large);
  for (const Task& a : small.tasks()) {
    int found = 0;
    for (const Task& b : more.tasks()) {
      const TaskInputs here = small.inputs(a.index), there = more.inputs(b.index);
      if (!(here == there)) continue;
      ++found;
      CHECK(a.sample == b.sample);
      CHECK(a.segments == b.segments);
      CHECK(small.spec(a.index).seed == more.spec(b.index).seed);
    }
    CHECK(found == 1);
  }
  const std::string trajectory = small.inputs(0).trajectory;
  for (const auto& [pointer, value] : std::map<std::string, std::string>{
           {"/seed", "4"}, {"/scene/damping_per_s", "1e-300"}, {"/solve", R"({"norm": "natural"})"}}) {
    CHECK(plan_of(with(pointer, value, full_job())).inputs(0).trajectory != trajectory);
  }
  CHECK(plan_of(with("/record/trajectory_every", "1", full_job())).inputs(0).record != small.inputs(0).record);
  // A time limit does not change a simulation.
  CHECK(plan_of(with("/task_time_limit_s", "5", full_job())).inputs(0).trajectory == trajectory);
}

TEST_CASE("what is copied stands at its new rows") {
  const TemporaryFolder folder;
  const Plan before = plan_of(full_job());
  make_file(folder / "old.h5", before, 5);
  Json large = full_job();
  large["samples"] = 3;
  const Plan plan = plan_of(large);
  const Extension extension(folder / "old.h5", plan);
  CHECK(extension.copied() == 5);  // two samples of three grid points, the last one not done
  CHECK(extension.source(4) == 3);
  CHECK(extension.source(2) == -1);

  const Task task = plan.task(4);
  TaskRecord taken;
  taken.prepare(task, axis_sizes(plan));
  REQUIRE(extension.take(4, taken));
  const TaskRecord written = synthetic_record(before, 3);
  CHECK(taken.steps.joint_gap == written.steps.joint_gap);
  CHECK(taken.solves.iterations == written.solves.iterations);
  CHECK(taken.trajectories.position_m == written.trajectories.position_m);
  CHECK(taken.trajectories.segments.radius_m == written.trajectories.segments.radius_m);
  CHECK(taken.trajectories.first_row[0] == written.trajectories.first_row[0] + task.rows[Rows::frame_segment].first -
                                               before.task(3).rows[Rows::frame_segment].first);
  CHECK(taken.timing.source_task[0] == 3);
}

}  // namespace test_extension
