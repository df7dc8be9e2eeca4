#include "runner/experiment/batched_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <new>
#include <numeric>
#include <utility>

#include "runner/dataset/stored_systems.hpp"
#include "runner/experiment/host_memory.hpp"
#include "runner/experiment/simulation_log.hpp"
#include "runner/experiment/solve_rows.hpp"
#include "solver/batch/batched_step.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {
namespace {

/// A task of the batch: its scene, copied from its lane for the record, and its results.
struct Member {
  const TaskRun& run;
  Scene scene;
  SimulationLog simulation;
  SystemStore systems;

  Member(const TaskRun& of, Scene start)
      : run(of),
        scene(std::move(start)),
        simulation(of.task, of.spec, *of.record, scene),
        systems(scene, of.spec.output.stored_iterations(of.spec.time.newton_iterations), *of.record) {}
  Member(const Member&) = delete;
  Member& operator=(const Member&) = delete;
};

/// Logs the columns of /solves and the system before the solve.
void log_before(const BatchedStepper& stepper, int lane, const SolvePosition& at, Member& member) {
  TaskRecord& record = *member.run.record;
  if (member.run.spec.output.solves) {
    const BatchedLinearization& linearization = stepper.system().linearization();
    const std::size_t row = solve_row(member.run.spec, 1, at);
    log_position(at, row, record);
    record.solves.newton_residual[row] = linearization.residual[lane];
    record.solves.joint_gap[row] = std::sqrt(linearization.squared_gap[lane]);
    record.solves.rhs_norm[row] = std::sqrt(linearization.squared_norm[lane]);
  }
  if (!member.systems.holds(at)) return;
  stepper.write(lane, member.scene);
  member.systems.before(member.scene.rods.front(), at, stepper.keeps_balance(lane));
}

/// Advances all active lanes by one step.
const std::vector<StepReport>& step(BatchedStepper& stepper, std::deque<Member>& members, int step) {
  const auto each = [&](const auto& visit) {
    for (std::size_t lane = 0; lane < members.size(); ++lane)
      if (stepper.iterates(static_cast<int>(lane))) visit(static_cast<int>(lane), members[lane]);
  };
  stepper.begin();
  for (int newton = 0; stepper.linearize(); ++newton) {
    const SolvePosition at{step, newton, 0};
    each([&](int lane, Member& member) { log_before(stepper, lane, at, member); });
    stepper.solve();
    each([&](int lane, Member& member) {
      if (member.systems.holds(at)) stepper.write_solution(lane, member.systems.solution(at));
    });
  }
  return stepper.end();
}

void fail(TaskRecord& record, const std::exception& error) {
  record.outcome = TaskOutcome::error;
  record.message = dynamic_cast<const std::bad_alloc*>(&error) ? out_of_memory_text() : error.what();
}

/// The members whose scenes can be built; the records of the others get the error.
std::deque<Member> built(const std::vector<TaskRun>& runs) {
  std::deque<Member> members;
  for (const TaskRun& run : runs) {
    try {
      members.emplace_back(run, build_scene(run.spec.scene));
    } catch (const std::exception& error) {
      fail(*run.record, error);
    }
  }
  return members;
}

bool simulate(std::deque<Member>& members, const StopRequested& stop) {
  const Stopwatch watch;
  std::vector<Scene> scenes;
  for (const Member& member : members) scenes.push_back(member.scene);
  const TimeSpec& time = members.front().run.spec.time;
  BatchedStepper stepper(scenes, step_settings(time),
                         time.balance ? std::optional(time.momentum_tolerance) : std::nullopt);

  std::vector<int> left(members.size());  // active lanes
  std::iota(left.begin(), left.end(), 0);
  /// Abandons the lanes for which `goes_on` is false.
  const auto keep = [&](const auto& goes_on) {
    const auto ends = [&](int lane) {
      if (goes_on(lane, members[static_cast<std::size_t>(lane)])) return false;
      stepper.abandon(lane);
      return true;
    };
    left.erase(std::remove_if(left.begin(), left.end(), ends), left.end());
  };
  for (int s = 0; s < time.steps; ++s) {
    if (stop && stop()) return false;
    keep([&](int, Member& member) { return !member.simulation.out_of_time(watch.seconds()); });
    if (left.empty()) break;
    const Stopwatch step_watch;
    const std::vector<StepReport>& reports = step(stepper, members, s);
    const double share_s = step_watch.seconds() / static_cast<double>(left.size());
    keep([&](int lane, Member& member) {
      stepper.write(lane, member.scene);
      TaskRecord& record = *member.run.record;
      const auto row = static_cast<std::size_t>(s);
      record.timing.rest_s[row] = static_cast<float>(share_s);
      record.timing.solve_s[row] = 0;  // the whole step is one computation
      record.steps.cg_iterations[row] = record.steps.products[row] = 0;
      return member.simulation.finish_step(s, member.scene, reports[static_cast<std::size_t>(lane)]);
    });
  }
  return true;
}

/// Evaluates at most BatchedRods::lanes tasks.
bool evaluate_at_once(const std::vector<TaskRun>& runs, const StopRequested& stop) {
  std::deque<Member> members = built(runs);
  try {
    return members.empty() || simulate(members, stop);
  } catch (const std::exception& error) {
    for (const Member& member : members) fail(*member.run.record, error);
    return true;
  }
}

}  // namespace

bool steps_in_batches(const TaskSpec& spec) {
  const OpenRod* rod = open_rod(spec.scene);
  return rod && spec.output.systems != StoredSystems::none && !rod->has_tip_load() && !rod->tip_motion &&
         rod->prescribed.is_nothing() && !rod->wind && !rod->contact &&
         (rod->stretch == Stretch::inextensible || rod->stretch_compliance_per_j);
}

BatchKey batch_key(const TaskSpec& spec) {
  const OpenRod& rod = *open_rod(spec.scene);
  const TimeSpec& time = spec.time;
  return {rod.segments,
          rod.clamp,
          time.step_s,
          time.integrator,
          time.steps,
          time.newton_iterations,
          time.newton_tolerance,
          time.balance ? time.momentum_tolerance : 0};
}

bool evaluate_batch(const std::vector<TaskRun>& runs, const StopRequested& stop) {
  const Stopwatch watch;
  bool finished = true;
  for (std::size_t first = 0; first < runs.size() && finished; first += BatchedRods::lanes) {
    const std::size_t end = std::min(first + BatchedRods::lanes, runs.size());
    finished = evaluate_at_once(
        {runs.begin() + static_cast<std::ptrdiff_t>(first), runs.begin() + static_cast<std::ptrdiff_t>(end)}, stop);
  }
  for (const TaskRun& run : runs) run.record->timing.elapsed_s[0] = watch.seconds() / static_cast<double>(runs.size());
  return finished;
}

bool evaluate_among_equals(const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested& stop) {
  if (!steps_in_batches(spec)) return evaluate(task, spec, record, stop);
  std::vector<TaskRecord> others(BatchedRods::lanes - 1, record);
  std::vector<TaskRun> runs{{task, spec, &record}};
  for (TaskRecord& other : others) runs.push_back({task, spec, &other});
  return evaluate_batch(runs, stop);
}

}  // namespace rodsweep
