#include <catch2/catch.hpp>

#include "runner/experiment/task_body.hpp"
#include "runner/file/extension.hpp"
#include "runner/plan/job_extension.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::StartsWith;

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

TEST_CASE("more samples, more values and more guesses extend a job, in any order and under other names") {
  const Json before = two_grids();
  CHECK(objection(before, before) == "");
  Json job = before;
  job["name"] = "other";
  job["description"] = "larger";
  job["samples"] = 3;
  job["scene"]["segments"] = grid({7, 5, 4});
  job["scene"]["radius_m"] = grid({0.01, 0.05});
  job["solve"] = {{"preconditioner", zip({"jacobi", "none", "icc"})}, {"tolerance", zip({1, 1e-1, 1e-2})}};
  job["guesses"] = Json::parse(R"(["linear", {"oracle": {"error": {"grid": [0.3, 0.2, 0.1]}, "label": "o"}},
                                   {"zero": {"label": "none"}}])");
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
  CHECK(changed("/guesses", R"(["zero", {"oracle": {"error": 0.1}}])") ==
        "new.json: guesses: \"oracle\" of old.h5 is missing");
  Json duration = without("/time/steps", before);
  duration["time"]["duration_s"] = 0.2;
  CHECK(objection(duration, before) == "new.json: time.steps: nothing here, 10 in old.h5");
}

TEST_CASE("a task is the same in another plan only where all that its results depend on is") {
  Json large = full_job();
  large["samples"] = 3;
  large["scene"]["segments"] = grid({7, 9, 5, 4});
  large["guesses"] = Json::parse(R"(["zero", {"previous": {"label": "p"}}, {"oracle": {"error": 0.2}}])");
  const Plan small = plan_of(full_job()), more = plan_of(large);
  for (const Task& a : small.tasks()) {
    int found = 0;
    for (const Task& b : more.tasks()) {
      const TaskIdentity here = small.identity(a.index), there = more.identity(b.index);
      if (here.trajectory != there.trajectory) continue;
      ++found;
      CHECK(a.sample == b.sample);
      CHECK(a.segments == b.segments);
      CHECK(small.spec(a.index).seed == more.spec(b.index).seed);
      CHECK(here.guesses[0] == there.guesses[0]);
      CHECK(here.guesses[1] == there.guesses[1]);
      CHECK(here.guesses[1] != there.guesses[2]);
    }
    CHECK(found == 1);
  }
  const std::string trajectory = small.identity(0).trajectory;
  for (const auto& [pointer, value] : std::map<std::string, std::string>{
           {"/seed", "4"}, {"/scene/damping_per_s", "1e-300"}, {"/solve", R"({"norm": "natural"})"}}) {
    CHECK(plan_of(with(pointer, value, full_job())).identity(0).trajectory != trajectory);
  }
  CHECK(plan_of(with("/record/trajectory_every", "1", full_job())).identity(0).record != small.identity(0).record);
  // A time limit does not change a simulation.
  CHECK(plan_of(with("/task_time_limit_s", "5", full_job())).identity(0).trajectory == trajectory);
}

TEST_CASE("what is taken over stands at its new rows, and a simulation that differs is told by its first value") {
  const TemporaryFolder folder;
  const Plan before = plan_of(full_job());
  make_file(folder / "old.h5", before, 5);
  Json large = full_job();
  large["samples"] = 3;
  large["record"]["trajectory_every"] = 2;
  large["guesses"] = {"linear", "previous", "zero"};
  const Plan plan = plan_of(large);
  const Extension extension(folder / "old.h5", plan);
  CHECK(extension.count(Extension::Use::complete) == 5);  // two samples of three grid points, the last one not done
  CHECK(extension.count(Extension::Use::copy) == 0);
  CHECK(extension.count(Extension::Use::run) == 4);
  CHECK(extension.source(4) == 3);
  CHECK(extension.source(2) == -1);

  const Task task = plan.task(4);
  TaskRecord taken;
  taken.prepare(task, axis_sizes(plan));
  REQUIRE(extension.take(4, taken));
  const TaskRecord written = synthetic_record(before, 3);
  CHECK(taken.steps.joint_gap == written.steps.joint_gap);
  CHECK(taken.trajectories.position_m == written.trajectories.position_m);
  CHECK(taken.trajectories.segments.radius_m == written.trajectories.segments.radius_m);
  CHECK(taken.timing.copied_guess == std::vector<std::int8_t>{-1, 1, 1});
  const std::size_t tolerances = tolerance_ladder().size();
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t t = 0; t < tolerances; ++t) {
      CHECK(taken.solves.iterations[(row * 3 + 0) * tolerances + t] == -1);
      CHECK(taken.solves.iterations[(row * 3 + 1) * tolerances + t] ==
            written.solves.iterations[(row * 2 + 1) * tolerances + t]);
      CHECK(taken.solves.iterations[(row * 3 + 2) * tolerances + t] ==
            written.solves.iterations[(row * 2 + 0) * tolerances + t]);
    }
  CHECK(taken.trajectories.first_row[0] == written.trajectories.first_row[0] + task.rows[Rows::frame_segment].first -
                                               before.task(3).rows[Rows::frame_segment].first);

  TaskRecord record = taken;  // as if simulated again with other guesses
  for (auto& iterations : record.solves.iterations) iterations = 7;
  CHECK(complete(task, record, taken) == "");
  CHECK(record.solves.iterations[0] == 7);
  CHECK(record.solves.iterations[tolerances] == taken.solves.iterations[tolerances]);
  CHECK(record.timing.source_task[0] == 3);

  TaskRecord other = taken;
  other.steps.kinetic_energy_j[2] = 0.5;
  CHECK_THAT(complete(task, other, taken), StartsWith("/steps/kinetic_energy_j, value 2, is 0.5 and was "));
  other = taken;
  other.outcome = TaskOutcome::diverged;
  other.message = "step 1: too far";
  CHECK(complete(task, other, taken) == "it ended as diverged (step 1: too far), before as ok ()");
  other = taken;  // a warning about a new guess, or about one that is copied, does not mean another trajectory
  other.message = "the guess gave two answers";
  CHECK(complete(task, other, taken) == "");
  CHECK(other.message == "the guess gave two answers");
  TaskRecord warned = taken;
  warned.message = "another guess gave two answers";
  other.message = "";
  CHECK(complete(task, other, warned) == "");
  CHECK(other.message == "another guess gave two answers");
}

TEST_CASE(
    "only the guesses that are missing are tried, and a trajectory that is another one ends the run with the task") {
  const TemporaryFolder folder;
  const Plan before = plan_of(full_job());
  make_file(folder / "old.h5", before, 6);
  Json large = full_job();
  large["guesses"] = {"linear", "zero", "previous"};
  const Plan plan = plan_of(large);
  const Extension extension(folder / "old.h5", plan);
  double gap = 0;
  const Evaluate evaluate = [&](const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested&) {
    CHECK(spec.settled == std::vector<std::uint8_t>{0, 1, 1});
    extension.take(task.index, record);  // the same trajectory
    record.steps.joint_gap[1] += gap;
    return true;
  };
  int written = 0;
  const WriteRecord write = [&](const Task&, const TaskRecord&, const TaskOrigin* origin) {
    written += origin == nullptr;
  };
  const auto warn = [](const std::string&) { FAIL("no damage"); };
  TaskBody body = extending_body(plan, extension, write, warn, evaluate);
  CHECK(body(3, {}).outcome == TaskOutcome::ok);
  CHECK(written == 1);
  gap = 1;
  const std::string text = message_of<FileError>([&] { body(4, {}); });
  CHECK_THAT(text, StartsWith("task 4, repeated for its new guesses, differs from " + (folder / "old.h5").native() +
                              ", task 4: /steps/joint_gap, value 1, is "));
  CHECK_THAT(text, Catch::Matchers::Contains("--resume without --extend"));
  CHECK(written == 1);
}

}  // namespace test_extension
