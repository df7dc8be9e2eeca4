// What a plan will cost, from a few of its tasks really run: the cheapest, the median and the dearest one by
// Task::cost, over as many of their first steps as fit into about half a second. Seconds per unit of cost are
// interpolated between them. An estimate: random parameters and later steps can be harder than those probed. Needs
// PETSc.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/experiment/task_body.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

struct Probe {
  std::int64_t task = 0;
  double cost = 0;
  std::int64_t steps = 0, of_steps = 0;  ///< run, and in the whole task
  double seconds = 0;                    ///< of the whole task, extrapolated from the steps run; without any, at least
  std::int64_t memory_bytes = 0;  ///< the most that the process had so far, cheaper probes included; 0: not known
  TaskOutcome outcome{};
  std::string message;
};

std::vector<Probe> probe(const Plan& plan, const Evaluate& evaluate);

/// Of all tasks on one core.
double core_seconds(const Plan& plan, const std::vector<Probe>& probes);

}  // namespace rodsweep
