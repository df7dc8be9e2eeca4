// A simulation that starts from a frame of another continues it, in every scene and by both integrators; and what comes
// to rest stays there.
#include <cmath>

#include "runner/measure/start_state.hpp"
#include "solver/step/projection.hpp"
#include "tests/catch.hpp"
#include "tests/laws/scene_samples.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep::law_every_start {

TEST_CASE("a simulation cut in two is the uncut one, in every scene and by both integrators") {
  const scene_samples::SceneFiles files;
  for (const Json& sample : scene_samples::samples())
    for (const char* integrator : {"euler", "bdf2"}) {
      INFO(sample["type"] << " by " << integrator);
      const Plan plan(files.job(sample, {{"time", {{"steps", 12}, {"integrator", integrator}}},
                                         {"record", {{"trajectory_every", 4}, {"states", true}}}}));
      const TaskSpec spec = plan.spec(0);
      const auto whole = std::make_shared<const TaskRecord>(record_of(plan));
      REQUIRE(whole->outcome == TaskOutcome::ok);
      for (const int frame : {0, 1, 2}) {
        Scene scene = build_scene(spec.scene);
        StartSpec spec_of_start;
        spec_of_start.time_s = 4 * frame * scene_samples::step_s;
        const StartState start(whole, spec_of_start, scene);
        CHECK(scene.time_s == Approx(*spec_of_start.time_s));
        DirectSolve direct(scene);
        LinearProjection projection(scene, direct, spec.time.momentum_tolerance);
        TimeStepper stepper(scene, step_settings(spec.time));
        start.continue_steps(stepper);
        for (int step = 4 * frame; step < 12; ++step) stepper.step(projection);
        double apart = 0;
        std::size_t row = static_cast<std::size_t>(3 * plan.task(0).segments);
        for (const Rod& rod : scene.rods)
          for (const Vector3& position : rod.position)
            apart =
                std::max(apart, (position - Vector3(Vector3::Map(whole->trajectories.position_m.row(row++)))).norm());
        CHECK(apart <= (scene.contact ? 1e-4 : 1e-15));
      }
    }
}

TEST_CASE("every scene that comes to rest stays where it is, in steps of the default") {
  const scene_samples::SceneFiles files;
  int rested = 0;
  for (const Json& sample : scene_samples::samples()) {
    INFO(sample["type"]);
    const Plan plan(files.job(sample, {{"time", {{"steps", 3000}, {"until", {{"rest", 1e-6}}}}},
                                       {"record", {{"trajectory_every", 3000}, {"states", true}}}}));
    const auto record = std::make_shared<const TaskRecord>(record_of(plan));
    if (record->outcome != TaskOutcome::ok) continue;  // a rod that is fed or pulled for ever tears
    const bool rests = record->message.find("not at rest") == std::string::npos;
    CHECK(rests == (record->tasks.steps_done[0] < 3000));
    if (!rests) continue;
    ++rested;
    const TaskSpec spec = Plan(files.job(sample)).spec(0);
    Scene scene = build_scene(spec.scene);
    const StartState start(record, {}, scene);
    std::vector<Vector3> before;
    for (const Rod& rod : scene.rods) before.insert(before.end(), rod.position.begin(), rod.position.end());
    DirectSolve direct(scene);
    LinearProjection projection(scene, direct, spec.time.momentum_tolerance);
    TimeStepper stepper(scene, step_settings(spec.time));
    for (int step = 0; step < 100; ++step) stepper.step(projection);
    double moved = 0;
    std::size_t s = 0;
    for (const Rod& rod : scene.rods)
      for (const Vector3& position : rod.position) moved = std::max(moved, (position - before[s++]).norm());
    CAPTURE(moved, record->tasks.steps_done[0]);
    CHECK(moved < 1e-4);
  }
  CHECK(rested >= 8);
}

}  // namespace rodsweep::law_every_start
