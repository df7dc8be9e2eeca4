// Estimates the time and memory of a plan from probes: the cheapest, median and dearest task by Task::cost. A probe
// runs the first steps of its task for about half a second, at most two. Seconds per unit of cost are interpolated between probes.
// Random parameters and later steps can be harder than those probed. Needs PETSc.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/measure/run_task.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

struct Probe {
  std::int64_t task = 0;
  double cost = 0;
  std::int64_t steps = 0, of_steps = 0;  ///< steps run; steps of the whole task
  double seconds = 0;                    ///< of the whole task, extrapolated from the steps run; a lower bound if none
  /// Peak memory of the process so far, including cheaper probes, plus the record of the steps not run; 0: unknown.
  std::int64_t memory_bytes = 0;
  TaskOutcome outcome{};
  std::string message;
};

using RunTask = std::function<bool(const Task&, const TaskSpec&, TaskRecord&, const TaskHooks&)>;
/// Tests replace `run` to pretend times.
std::vector<Probe> probe(const Plan& plan, const RunTask& run = run_task);

/// Estimated times on one core.
struct Estimate {
  std::int64_t tasks = 0;
  double core_s = 0;     ///< all tasks
  double longest_s = 0;  ///< the longest task
  std::int64_t longest = 0;

  double wall_s(int workers) const;
  double tasks_per_s(int workers) const;  ///< rate that the master must send to keep all workers busy
};

Estimate estimate(const Plan& plan, const std::vector<Probe>& probes);

/// Tasks per second that one master can send. A task takes 4 to 19 us of its CPU time with several workers. With one
/// worker it takes 105 us, because the master wakes up for each task (tests/bench/bench_limits.py; docs/scale.md).
inline constexpr double master_tasks_per_s = 10'000;

/// The number of shards for which each master sends at most half of its maximum rate.
int shards_for(double tasks_per_s);

/// Time limit for the batch system, in seconds, to run jobs/slurm/sweep.sbatch for `wall_s`. Adds 50 % for the error of
/// the estimate, and the time to start and stop.
double time_limit_for(double wall_s);

}  // namespace rodsweep
