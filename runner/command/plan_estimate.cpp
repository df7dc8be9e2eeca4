#include "runner/command/plan_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runner/measure/host_memory.hpp"

namespace rodsweep {

namespace {

constexpr double enough_s = 0.5, too_long_s = 2;

/// Reduces a task to its first `steps` steps.
void truncate(Task& task, TaskSpec& spec, int steps) {
  spec.time.steps = steps;
  size_rows(task, spec.scene, spec.time, spec.output);
  spec.time_limit_s = spec.time_limit_s > 0 ? std::min(spec.time_limit_s, too_long_s) : too_long_s;
}

Probe probe_task(const Plan& plan, std::int64_t index, const RunTask& run) {
  const Task whole = plan.task(index);
  const TaskSpec whole_spec = plan.spec(index);
  const AxisSizes sizes = axis_sizes(plan);
  const PerRows<std::int64_t> of_a_row = row_bytes(sizes);
  TaskRecord record;
  for (std::int64_t steps = std::min<std::int64_t>(whole.steps, 4);; steps = std::min(2 * steps, whole.steps)) {
    Task task = whole;
    TaskSpec spec = whole_spec;
    truncate(task, spec, static_cast<int>(steps));
    record.prepare(task, sizes);
    run(task, spec, record, {});
    const double seconds = record.timing.elapsed_s.front();
    if (seconds < enough_s && steps < whole.steps && record.outcome == TaskOutcome::ok) continue;

    const auto done = static_cast<std::int64_t>(record.tasks.steps_done.front());
    const auto memory = static_cast<std::int64_t>(peak_memory());
    // A step cut off by the time limit counts as half a step, unless it was the first.
    const double cut = record.outcome == TaskOutcome::timed_out ? 0.5 : 0;
    const double step_s = seconds / std::max(1.0, static_cast<double>(done) + cut);
    return {index,
            whole.cost,
            done,
            whole.steps,
            step_s * static_cast<double>(whole.steps),
            memory > 0 ? memory + record_bytes(whole, of_a_row) - record_bytes(task, of_a_row) : 0,
            record.outcome,
            record.message};
  }
}

/// Seconds per unit of cost, interpolated at `cost`; probes are in ascending order of cost.
double rate(const std::vector<Probe>& probes, double cost) {
  const auto of = [](const Probe& p) { return p.seconds / p.cost; };
  const auto above = std::find_if(probes.begin(), probes.end(), [&](const Probe& p) { return p.cost >= cost; });
  if (above == probes.begin()) return of(probes.front());
  if (above == probes.end()) return of(probes.back());
  const Probe& below = *(above - 1);
  const double way = (cost - below.cost) / (above->cost - below.cost);
  return (1 - way) * of(below) + way * of(*above);
}

}  // namespace

std::vector<Probe> probe(const Plan& plan, const RunTask& run) {
  std::vector<std::int64_t> by_cost(static_cast<std::size_t>(plan.size()));
  std::iota(by_cost.begin(), by_cost.end(), 0);
  std::stable_sort(by_cost.begin(), by_cost.end(),
                   [&](std::int64_t a, std::int64_t b) { return plan.cost(a) < plan.cost(b); });
  std::vector<std::size_t> places{0, by_cost.size() / 2, by_cost.size() - 1};
  places.erase(std::unique(places.begin(), places.end()), places.end());
  std::vector<Probe> probes;
  for (const std::size_t place : places) probes.push_back(probe_task(plan, by_cost[place], run));
  return probes;
}

Estimate estimate(const Plan& plan, const std::vector<Probe>& probes) {
  Estimate all;
  all.tasks = plan.size();
  for (const Task& task : plan.tasks()) {
    const double seconds = task.cost * rate(probes, task.cost);
    all.core_s += seconds;
    if (seconds > all.longest_s) all.longest_s = seconds, all.longest = task.index;
  }
  return all;
}

double Estimate::wall_s(int workers) const { return std::max(longest_s, core_s / workers); }

double Estimate::tasks_per_s(int workers) const { return static_cast<double>(tasks) / wall_s(workers); }

int shards_for(double tasks_per_s) {
  return std::max(1, static_cast<int>(std::ceil(tasks_per_s / (master_tasks_per_s / 2))));
}

double time_limit_for(double wall_s) {
  constexpr double margin = 1.5, stop_s = 210, start_s = 60;
  return margin * wall_s + stop_s + start_s;
}

}  // namespace rodsweep
