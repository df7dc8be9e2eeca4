// What a plan will cost, from a few of its tasks really run: the cheapest, the median and the dearest one by
// Task::cost, over as many of their first steps as fit into about half a second. Seconds per unit of cost are
// interpolated between them. An estimate: random parameters and later steps can be harder than those probed. Needs
// PETSc.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/experiment/task_body.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

struct Probe {
  std::int64_t task = 0;
  double cost = 0;
  std::int64_t steps = 0, of_steps = 0;  ///< run, and in the whole task
  double seconds = 0;                    ///< of the whole task, extrapolated from the steps run; without any, at least
  /// The most that the process had so far, cheaper probes included, and the record of the steps left out; 0: not known.
  std::int64_t memory_bytes = 0;
  TaskOutcome outcome{};
  std::string message;
};

std::vector<Probe> probe(const Plan& plan, const Evaluate& evaluate);

/// What tasks will take on one core.
struct Estimate {
  std::int64_t tasks = 0;
  double core_s = 0;     ///< all of them
  double longest_s = 0;  ///< the longest
  std::int64_t longest = 0;

  double wall_s(int workers) const;
  double tasks_per_s(int workers) const;  ///< that so many workers, all of them busy, take from the master
};

Estimate estimate(const Plan& plan, const std::vector<Probe>& probes);

/// What one master hands out: a task takes 22 us of its processor with four workers and 111 us with one, for which it
/// wakes up each time (tests/bench/bench_limits.py; docs/scale.md).
inline constexpr double master_tasks_per_s = 10'000;

/// Shards, each with a master of its own, of which none has to hand out more than half of what it can.
int shards_for(double tasks_per_s);

/// What to ask a batch system for, in seconds, so that jobs/slurm/sweep.sbatch has `wall_s` to run: half as much again,
/// since estimates are what they are, and what starting and stopping take.
double time_limit_for(double wall_s);

}  // namespace rodsweep
