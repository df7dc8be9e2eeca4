#include "runner/measure/run_task.hpp"

#include <exception>
#include <memory>
#include <new>
#include <optional>

#include "runner/dataset/stored_systems.hpp"
#include "runner/measure/host_memory.hpp"
#include "runner/measure/measured_solve.hpp"
#include "runner/measure/projections.hpp"
#include "runner/measure/simulation_log.hpp"
#include "runner/measure/start_state.hpp"
#include "solver/linear/interruption.hpp"
#include "solver/step/relaxation.hpp"
#include "solver/step/stopwatch.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {
namespace {

class ObservedSolve : public LinearSolve {
 public:
  ObservedSolve(const Scene& scene, LinearSolve& solve, const ObserveSystem& observe)
      : scene_(scene), solve_(solve), observe_(observe) {}

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override {
    const SolveOutcome outcome = solve_.solve(system, at, assemble_s, delta_lambda);
    observe_(scene_.rods[static_cast<std::size_t>(at.rod)], system, at, delta_lambda);
    return outcome;
  }

 private:
  const Scene& scene_;
  LinearSolve& solve_;
  const ObserveSystem& observe_;
};

/// Builds the scene and its systems and runs the steps; sets outcome and message. Returns false if abandoned between
/// steps. If interrupted elsewhere, throws InterruptedComputation and sets no ratios: the last system may lack guesses.
bool simulate(const Task& task, const TaskSpec& spec, TaskRecord& record, const TaskHooks& hooks,
              const Stopwatch& watch) {
  const auto is_late = [&] { return spec.time_limit_s > 0 && watch.seconds() > spec.time_limit_s; };
  const Interruptible interruptible([&] { return hooks.stop() || is_late(); }, hooks.clock);
  Scene scene = build_scene(spec.scene);
  std::optional<StartState> start;
  if (spec.start) start.emplace(*spec.start, scene);
  MeasuredSolve solve(scene, spec, record);
  std::optional<StoringSolve> storing;
  if (const int iterations = spec.output.stored_iterations(spec.time.newton_iterations); iterations > 0)
    storing.emplace(scene, iterations, solve, record);
  LinearSolve* outermost = storing ? static_cast<LinearSolve*>(&*storing) : &solve;
  std::optional<ObservedSolve> observed;
  if (hooks.observe) outermost = &observed.emplace(scene, *outermost, hooks.observe);
  const std::unique_ptr<Projection> projection = make_projection(scene, spec, record, *outermost);
  TimeStepper stepper(scene, step_settings(spec.time));
  if (start) start->continue_steps(stepper);
  std::optional<Relaxation> relaxation;
  if (spec.time.until) relaxation.emplace(scene, spec.time.until->rest, spec.time.step_s);

  record.timing.steps_processor_s[0] = 0;
  SimulationLog simulation(task, spec, record, scene, stepper);
  for (int step = 0; step < spec.time.steps; ++step) {
    if (hooks.stop()) return false;
    if (simulation.out_of_time(watch.seconds())) break;
    solve.take_elapsed_s();
    const Stopwatch step_watch;
    const ProcessorStopwatch processor_watch;
    const StepReport report = stepper.step(*projection);
    if (step > 0) record.timing.steps_processor_s[0] += processor_watch.seconds();  // the first sets up solvers
    const auto row = static_cast<std::size_t>(step);
    record.timing.rest_s[row] = static_cast<float>(step_watch.seconds() - solve.take_elapsed_s());
    const SolveEffort effort = solve.take_effort();
    record.timing.solve_s[row] = static_cast<float>(effort.seconds);
    record.steps.cg_iterations[row] = effort.iterations;
    record.steps.products[row] = effort.products;
    if (!simulation.finish_step(step, scene, report)) break;
    if (!relaxation) continue;
    if (relaxation->settle(scene)) {
      simulation.finish_at_rest(step, scene);
      break;
    }
    simulation.lacks(relaxation->lacking());
  }
  simulation.finish();
  solve.finish();
  return true;
}

}  // namespace

bool run_task(const Task& task, const TaskSpec& spec, TaskRecord& record, const TaskHooks& hooks) {
  const Stopwatch watch(hooks.clock);
  bool finished = true;
  try {
    finished = simulate(task, spec, record, hooks, watch);
  } catch (const InterruptedComputation& interrupted) {
    finished = !hooks.stop();
    if (finished) end_late(spec, record, interrupted.where());
  } catch (const std::bad_alloc&) {
    record.outcome = TaskOutcome::error;
    record.message = out_of_memory_text();
  } catch (const std::exception& error) {
    record.outcome = TaskOutcome::error;
    record.message = error.what();
  }
  record.timing.elapsed_s[0] = watch.seconds();
  return finished;
}

}  // namespace rodsweep
