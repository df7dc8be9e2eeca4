#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <thread>

#include "network/processor/coping_net.hpp"
#include "runner/command/commands.hpp"
#include "runner/command/plan_estimate.hpp"
#include "runner/command/run_command.hpp"
#include "runner/file/results_file.hpp"
#include "runner/measure/host_memory.hpp"
#include "runner/measure/plan_check.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/text/beside_program.hpp"
#include "runner/training/learning_sets.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

struct Bounds {
  std::int64_t least, most;
  std::string text() const { return least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most); }
};

template <class Member>
Bounds bounds(const Plan& plan, Member member) {
  const std::int64_t first = plan.task(0).*member;
  Bounds out{first, first};
  for (const Task& task : plan.tasks()) {
    out.least = std::min<std::int64_t>(out.least, task.*member);
    out.most = std::max<std::int64_t>(out.most, task.*member);
  }
  return out;
}

/// Upper bound of the linear systems (Gauss-Seidel: iterations), reached if no step ends early.
/// Task::cost is segments x steps x systems per step.
std::int64_t most_systems(const Plan& plan) {
  double systems = 0;
  for (const Task& task : plan.tasks()) systems += task.cost / task.segments;
  return std::llround(systems);
}

std::int64_t all_steps(const Plan& plan) {
  std::int64_t steps = 0;
  for (const Task& task : plan.tasks()) steps += task.steps;
  return steps;
}

int cores_here() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

int workers_of(const PlanOptions& options) { return options.workers > 0 ? options.workers : cores_here(); }

/// The format of sbatch --time, rounded up to minutes.
std::string slurm_time(double seconds) {
  const auto minutes = std::llround(std::ceil(seconds / 60));
  const auto hours = minutes / 60, days = hours / 24;
  return (days > 0 ? fmt::format("{}-", days) : "") + fmt::format("{:02}:{:02}:00", hours % 24, minutes % 60);
}

std::string slurm_text(const Estimate& needs, const PlanOptions& options) {
  const int workers = workers_of(options);
  const fs::path found = beside_program({"../share/rodsweep/jobs/slurm/sweep.sbatch", "../jobs/slurm/sweep.sbatch"});
  const fs::path script = found.empty() ? fs::path("jobs/slurm/sweep.sbatch") : found;
  std::error_code error;
  return fmt::format(
      "slurm    RODSWEEP={} sbatch --ntasks={} --time={} {} {} runs it in one job; at least --time={}: task {}, the "
      "longest, takes about {}\n",
      shell_quoted(fs::read_symlink("/proc/self/exe", error).native()), workers,
      slurm_time(time_limit_for(needs.wall_s(workers))), shell_quoted(script.native()),
      shell_quoted(fs::absolute(options.job).lexically_normal().native()), slurm_time(time_limit_for(needs.longest_s)),
      needs.longest, duration_text(needs.longest_s));
}

/// What stops or surprises the run: implausible values, too little disk space, failed probes, months of computing.
std::vector<std::string> warnings_of(const Plan& plan, const std::vector<Probe>& probes, const PlanOptions& options) {
  std::vector<std::string> warnings = plan.job().warnings;
  RunOptions run;
  const fs::path output = output_of(run, plan.job().name);
  const fs::path folder = fs::exists(output.parent_path()) ? output.parent_path() : fs::path(".");
  const auto available = static_cast<std::int64_t>(free_bytes(folder));
  if (const std::int64_t bytes = file_bytes(plan); bytes > available)
    warnings.push_back(
        fmt::format("the file needs {}, but {} has {} free: record less, or choose another disk with run -o",
                    bytes_text(bytes), folder.native(), bytes_text(available)));
  for (const Probe& p : probes)
    if (p.outcome == TaskOutcome::timed_out && p.steps == 0)
      warnings.push_back(fmt::format("task {}: no step finished in {}; the time above is a lower bound", p.task,
                                     duration_text(p.seconds / static_cast<double>(p.of_steps))));
    else if (p.outcome != TaskOutcome::ok && p.outcome != TaskOutcome::timed_out)
      warnings.push_back(fmt::format("task {} {}: {}", p.task, to_string(p.outcome), p.message));
  constexpr double month_s = 30 * 86400.0;
  const int workers = workers_of(options);
  if (const double wall_s = probes.empty() ? 0 : estimate(plan, probes).wall_s(workers); wall_s > month_s)
    warnings.push_back(fmt::format("{} with {}: fewer samples or steps, or more workers, bring it below a month",
                                   duration_text(wall_s), count_text(workers, "worker")));
  return warnings;
}

/// A warning if the workers need more tasks per second than one master can send; else empty.
std::string master_text(const Estimate& needs, int workers) {
  const double wanted = needs.tasks_per_s(workers);
  const int shards = shards_for(wanted);
  if (shards == 1) return "";
  return fmt::format(
      "master   {} workers need {:.0f} tasks/s, one master sends about {:.0f}: use {} shards (run --shard, then "
      "merge)\n",
      workers, wanted, master_tasks_per_s, shards);
}

/// Those that vary over the tasks.
std::vector<std::string> swept_keys(const Plan& plan) {
  std::vector<std::string> keys;
  for (const ParameterColumn& parameter : plan.parameters())
    if (parameter.swept) keys.push_back(parameter.path);
  return keys;
}

nlohmann::ordered_json to_json(const Plan& plan, const std::vector<Probe>& probes, const PlanOptions& options) {
  nlohmann::ordered_json json{{"job", plan.job().path.native()},
                              {"name", plan.job().name},
                              {"tasks", plan.size()},
                              {"steps", all_steps(plan)},
                              {"most_systems", most_systems(plan)},
                              {"guesses", plan.guess_labels()},
                              {"stored_systems", plan.rows(Rows::system)},
                              {"file_bytes", file_bytes(plan)}};
  json["swept"] = swept_keys(plan);
  json["warnings"] = warnings_of(plan, probes, options);
  if (probes.empty()) return json;
  const Estimate needs = estimate(plan, probes);
  const int workers = workers_of(options);
  json["core_hours"] = needs.core_s / 3600;
  json["workers"] = workers;
  json["wall_seconds"] = needs.wall_s(workers);
  json["time_limit_seconds"] = time_limit_for(needs.wall_s(workers));
  json["tasks_per_second"] = needs.tasks_per_s(workers);
  json["shards"] = shards_for(needs.tasks_per_s(workers));
  json["longest_task"] = needs.longest;
  json["longest_task_seconds"] = needs.longest_s;
  json["least_time_limit_seconds"] = time_limit_for(needs.longest_s);
  json["probes"] = nlohmann::ordered_json::array();
  for (const Probe& p : probes)
    json["probes"].push_back({{"task", p.task},
                              {"steps_run", p.steps},
                              {"steps", p.of_steps},
                              {"task_seconds", p.seconds},
                              {"memory_bytes", p.memory_bytes},
                              {"outcome", to_string(p.outcome)},
                              {"message", p.message}});
  return json;
}

std::string to_text(const Plan& plan, const std::vector<Probe>& probes, const PlanOptions& options) {
  const int workers = workers_of(options);
  RunOptions run;
  run.job = options.job;
  run.program = options.program;

  std::string text = fmt::format("job      {} ({})\n", plan.job().name, plan.job().path.native());
  text += fmt::format("tasks    {}, each {} segments, {} steps\n", plan.size(), bounds(plan, &Task::segments).text(),
                      bounds(plan, &Task::steps).text());
  if (const auto swept = swept_keys(plan); !swept.empty()) text += fmt::format("swept    {}\n", fmt::join(swept, ", "));
  text += fmt::format("steps    {}\n", all_steps(plan));
  const auto guesses = plan.guess_labels().size();
  text += fmt::format("systems  {} at most{}{}\n", most_systems(plan),
                      plan.rows(Rows::system) > 0 ? fmt::format(", of which {} recorded", plan.rows(Rows::system)) : "",
                      guesses > 0 ? fmt::format(", guesses: {}", fmt::join(plan.guess_labels(), ", ")) : "");
  text += fmt::format("file     {}\n", bytes_text(file_bytes(plan)));
  if (!probes.empty()) {
    const Estimate needs = estimate(plan, probes);
    const auto [shortest, longest] = std::minmax_element(
        probes.begin(), probes.end(), [](const Probe& a, const Probe& b) { return a.seconds < b.seconds; });
    text += fmt::format("time     about {:.2g} core-hours: {} with {} (from {} tried, {} to {} each)\n",
                        needs.core_s / 3600, duration_text(needs.wall_s(workers)), count_text(workers, "worker"),
                        count_text(static_cast<std::int64_t>(probes.size()), "task"), duration_text(shortest->seconds),
                        duration_text(longest->seconds));
    text += master_text(needs, workers);
    text += slurm_text(needs, options);
    const auto most = std::max_element(probes.begin(), probes.end(), [](const Probe& a, const Probe& b) {
                        return a.memory_bytes < b.memory_bytes;
                      })->memory_bytes;
    if (most > 0)
      text +=
          fmt::format("memory   at most {} for each tried task; this host has memory for {:.0f} processes\n",
                      bytes_text(most), std::floor((1 - memory_reserve) * host_memory() / static_cast<double>(most)));
  }
  for (const std::string& warning : warnings_of(plan, probes, options)) text += fmt::format("warning  {}\n", warning);
  if (workers > 1 && workers <= cores_here()) run.workers = workers;
  text += "next     " + run_line(run, ranks_for(workers));
  return text;
}

/// Sizes of a training. The numbers of examples and steps are upper bounds: a system whose base guess is exact gives no
/// example, and later Newton iterations may be left out.
struct Extent {
  std::size_t parameters = 0;
  std::int64_t training_simulations = 0, validation_simulations = 0;
  std::int64_t training_examples = 0, validation_examples = 0;
  std::int64_t steps_per_epoch = 0, steps = 0;
};

Extent extent_of(const TrainingJob& job, const LearningSets& sets) {
  Extent extent;
  extent.parameters = CopingNet<float>(job.network, 0).parameters().values().size();
  extent.training_simulations = static_cast<std::int64_t>(sets.training().size());
  extent.validation_simulations = static_cast<std::int64_t>(sets.validation().size());
  for (const LearningSets::Simulation& simulation : sets.training())
    extent.training_examples += (1 + job.copies().count) * systems_of(simulation);
  for (const LearningSets::Simulation& simulation : sets.validation())
    extent.validation_examples += systems_of(simulation);
  extent.steps_per_epoch = extent.training_examples / job.training.batch;
  extent.steps = extent.steps_per_epoch * job.training.epochs;
  return extent;
}

nlohmann::ordered_json to_json(const Job& job, const TrainingJob& training, const Extent& extent) {
  return {{"job", job.path.native()},
          {"name", job.name},
          {"data", paths_of(training.data)},
          {"parameters", extent.parameters},
          {"training_simulations", extent.training_simulations},
          {"validation_simulations", extent.validation_simulations},
          {"most_training_examples", extent.training_examples},
          {"most_validation_examples", extent.validation_examples},
          {"epochs", training.training.epochs},
          {"most_steps", extent.steps}};
}

std::string to_text(const PlanOptions& options, const Job& job, const TrainingJob& training, const Extent& extent) {
  RunOptions run;
  run.job = options.job;
  run.program = options.program;
  return fmt::format(
      "job       {} ({})\n"
      "data      {}\n"
      "examples  at most {} from {} simulations for training, {} from {} for validation\n"
      "network   {} parameters\n"
      "steps     at most {}: {} in each of {} epochs\n"
      "next      {}",
      job.name, job.path.native(), paths_of(training.data), extent.training_examples, extent.training_simulations,
      extent.validation_examples, extent.validation_simulations, extent.parameters, extent.steps,
      extent.steps_per_epoch, training.training.epochs, run_line(run, 1));
}

ExitCode show_training_plan(const PlanOptions& options, const Job& job, Console& console) {
  const TrainingJob training = training_job(job.values, job.path);
  const Extent extent = extent_of(training, LearningSets(training, job));
  console.result(options.json ? json_text(to_json(job, training, extent)) : to_text(options, job, training, extent));
  return ExitCode::ok;
}

}  // namespace

ExitCode execute(const PlanOptions& options, Console& console) {
  const Job job = read_job(options.job);
  check_inputs(job);
  if (is_training(job)) return show_training_plan(options, job, console);
  const Plan plan = checked_plan(job);
  limit_memory((1 - memory_reserve) * host_memory());
  const std::vector<Probe> probes = options.probe ? probe(plan) : std::vector<Probe>();
  console.result(options.json ? json_text(to_json(plan, probes, options)) : to_text(plan, probes, options));
  return ExitCode::ok;
}

}  // namespace rodsweep
