#include "runner/command/commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <sstream>

#include "runner/file/provenance.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

constexpr const char* about =
    "rodsweep measures how many conjugate-gradient iterations an initial guess saves in Cosserat rod simulations.\n"
    "It runs sweeps of simulations over MPI, with one HDF5 results file per sweep.";

constexpr const char* exit_codes =
    "Exit codes:\n"
    "  0  success\n"
    "  2  error in the command line, a job or a file; nothing was changed\n"
    "  3  the sweep is complete, but some tasks failed\n"
    "  4  stopped early; --resume continues\n"
    "  5  stopped early; the tasks need a longer --time-limit or more memory\n"
    "  6  all workers were lost; --resume continues\n"
    "  7  standard output could not be written; everything else succeeded\n"
    "  8  compare: the results differ\n"
    "  9  the training diverged; its best model is kept\n"
    "  10 info --verify, compare: results in a file are damaged";

constexpr const char* main_help =
    "Examples:\n"
    "  rodsweep validate jobs/demo.json         check a job\n"
    "  rodsweep plan jobs/demo.json             estimate tasks, bytes and core-hours\n"
    "  rodsweep run jobs/demo.json -n 8         run a job with 8 workers on this machine\n"
    "  rodsweep status results/demo.h5          show the progress, also during the run\n"
    "  rodsweep query results/demo.h5           list the tasks as a table, CSV or JSON\n"
    "'rodsweep COMMAND --help' shows the help of a command.\n\n"
    "The scripts in analysis/ are commands too: rodsweep NAME starts rodsweep-NAME. They need Python.\n"
    "  query    tasks as a table            compare  two sweeps            summary  the main numbers\n"
    "  report   an HTML page                spatial  figures               export   CSV of all rows\n"
    "  new      a guess of your own         score    that guess against all others";

constexpr const char* run_help =
    "A single rank runs the tasks itself. With -n N, N workers run them, and a master that sleeps sends them: mpirun\n"
    "starts N+1 ranks on this machine. On several hosts, start mpirun or srun yourself, with one rank more than "
    "cores.\n"
    "A training (kind \"train\") has no master. One rank uses all its cores, up to training.shards and\n"
    "OMP_NUM_THREADS. On several hosts, use one rank per host.\n\n"
    "SIGTERM, SIGINT (Ctrl-C), SIGUSR1, SIGUSR2, SIGXCPU and SIGHUP (unless ignored, as by nohup) stop the sweep\n"
    "within seconds. Running tasks are abandoned, also within a solve; finished tasks are kept. mpirun passes SIGUSR1\n"
    "and SIGUSR2 to all ranks and exits with 4. On SIGTERM and SIGINT it kills ranks that still run a second later,\n"
    "and exits with 1. Every stopped sweep can be resumed.\n"
    "A training stops between two steps; --resume continues it with bitwise equal results.\n\n"
    "Examples:\n"
    "  rodsweep run jobs/smoke.json                        one core, results/smoke.h5\n"
    "  rodsweep run job.json -n 4                          4 cores\n"
    "  mpirun -n 65 rodsweep run job.json -o out.h5 --resume\n"
    "                                                      on several hosts; continues or creates out.h5: for batch\n"
    "                                                      scripts\n"
    "  rodsweep run job.json -o out.h5 --resume --retry-failed\n"
    "                                                      also repeats errors, timeouts and crashes\n"
    "  rodsweep run job.json -o out.h5 --resume --retry-failed --task-time-limit 3600\n"
    "                                                      the same, with an hour for each task\n"
    "  rodsweep run job.json -n 2 --memory-limit-gb 20\n"
    "                                                      instead of an equal share for each worker\n"
    "  rodsweep run more.json -o more.h5 --extend out.h5   more.json: job.json with more samples or more grid values.\n"
    "                                                      Copies the results of out.h5 and runs the other tasks.\n"
    "                                                      out.h5 stays unchanged; more.h5 equals a full new run.";

constexpr const char* plan_help =
    "Runs parts of up to three tasks (cheapest, median, most expensive), unless --no-probe is given. Of a training it\n"
    "prints the size; `run` prints the time that is left. The data set of a training must exist.\n\n"
    "Examples:\n"
    "  rodsweep plan jobs/spatial_bending.json\n"
    "  rodsweep plan jobs/spatial_bending.json --workers 64      resources to request from Slurm";

constexpr const char* validate_help =
    "Every job is expanded in full: `run` accepts jobs that pass. Nothing is computed or written. Models and data\n"
    "sets of a job must exist, or another given job must make them (the job named NAME makes results/NAME.h5). A\n"
    "warning is printed for values that may be in the wrong unit.\n\n"
    "Examples:\n"
    "  rodsweep validate my.json\n"
    "  rodsweep validate data.json train.json use.json     each job uses the file of the one before\n"
    "  rodsweep validate --later jobs/*.json               accepts missing models and data sets";

constexpr const char* status_help =
    "Only reads the file, also during a run. The exit code is 0 in every state: scripts can read --json. A running\n"
    "sweep locks the file. Without file locks, it counts as running while it updates the time of the file. The\n"
    "remaining time is the run's own estimate, from the cost of the tasks that are left and the pace of the last "
    "ones.\n\n"
    "Examples:\n"
    "  rodsweep status results/demo.h5 --json | jq .pending\n"
    "  rodsweep status results/demo.h5 --watch           a line every 5 seconds until it ends";

constexpr const char* info_help =
    "Examples:\n"
    "  rodsweep info results/demo.h5                     job, axes, and all runs with versions\n"
    "  rodsweep info results/demo.h5 --verify            compares the data with their checksums\n"
    "  rodsweep info results/demo.h5 --job > again.json  writes the job of the results";

constexpr const char* rerun_help =
    "The job is read from FILE, not from its job file. Relative paths start at the folder of the job file. The new\n"
    "file holds one task; all commands can read it: `rodsweep compare FILE NEW` says whether the results are the "
    "same.\n"
    "SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 stop it within seconds; then nothing is written.\n\n"
    "Examples:\n"
    "  rodsweep rerun results/demo.h5 12                               every step into results/demo-task-12.h5\n"
    "  rodsweep rerun results/long.h5 3 --trajectory-every 100 -o three.h5\n"
    "  rodsweep compare results/long.h5 three.h5\n\n"
    "Exit codes:\n"
    "  0  the task is ok\n"
    "  2  error in the command line or the file; nothing was written\n"
    "  3  the task failed; its results were written\n"
    "  4  stopped early; nothing was written";

constexpr const char* systems_help =
    "The job is read from FILE, not from its job file. Relative paths start at the folder of the job file. Nothing is\n"
    "kept in sweeps for this: the same task solves the same systems again.\n"
    "In Python, rodsweep.systems(\"OUTPUT\") has A as a scipy matrix; rodsweep-matrices writes other formats.\n"
    "SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 stop it within seconds; then nothing is written.\n\n"
    "Examples:\n"
    "  rodsweep systems results/demo.h5 12                      every tenth step into results/demo-systems-12.h5\n"
    "  rodsweep systems results/demo.h5 12 --every 1 --first -o all.h5\n\n"
    "Exit codes:\n"
    "  0  written\n"
    "  2  error in the command line or the file; nothing was written\n"
    "  3  the task failed; its systems up to there are written\n"
    "  4  stopped early; nothing was written";

constexpr const char* merge_help =
    "The files hold finished tasks of one job, for example shards of a job array. The new file holds all of them,\n"
    "bit for bit as a single run would write them. It also records which run computed each task. Damaged tasks\n"
    "(wrong checksum) are left to do. If several files hold a task, the first is used; a warning is printed if the\n"
    "results differ. All other tasks are pending: `rodsweep run JOB -o OUTPUT --resume` runs them.\n\n"
    "Examples:\n"
    "  rodsweep run job.json --shard 1/2                results/NAME-1of2.h5, on one host\n"
    "  rodsweep run job.json --shard 2/2                results/NAME-2of2.h5, on another host\n"
    "  rodsweep merge results/NAME-*of2.h5 -o results/NAME.h5\n"
    "  sbatch --array=1-16 jobs/slurm/sweep.sbatch job.json";

constexpr const char* schema_help =
    "Editors use the schema for completion and checks; `rodsweep validate` checks more. Put the file into the\n"
    "folder of your jobs and name it in each job: \"$schema\": \"schema.json\".\n\n"
    "Example:\n"
    "  rodsweep schema >schema.json";

constexpr const char* help_line = "\nRun with --help for more information.\n";

std::string with_exit_codes(const char* help) { return std::string(help) + "\n\n" + exit_codes; }

std::string typed(int argc, const char* const* argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) line += (i > 0 ? " " : "") + shell_quoted(argv[i]);
  return line;
}

/// "rodsweep 2.0.0 (revision ...)", then one line per library.
std::string version_text() {
  std::string text = library_versions() + '\n';
  for (std::size_t at = text.find("; "); at != std::string::npos; at = text.find("; ", at)) text.replace(at, 2, "\n  ");
  return text.insert(text.find('\n'), " (revision " + source_revision() + ")");
}

// Replaces CLI11's validators, whose messages print the largest double.
CLI::Validator number_check(double least, bool may_be_least, const char* bound) {
  return CLI::Validator(
      [least, may_be_least, bound](std::string& text) {
        double value = 0;
        constexpr double most = 1e9;  // also rejects infinity and NaN
        const bool good = CLI::detail::lexical_cast(text, value) && value <= most &&
                          (value > least || (may_be_least && value == least));
        return good ? std::string() : fmt::format("{} is not allowed; must be a number {}", text, bound);
      },
      "");
}
CLI::Validator above_zero() { return number_check(0, false, "above 0 and at most 1e9"); }
CLI::Validator not_negative() { return number_check(0, true, "from 0 to 1e9"); }

CLI::App* add_command(CLI::App& app, const char* name, const char* help, const std::string& footer) {
  CLI::App* command = app.add_subcommand(name, help);
  command->footer(footer);
  return command;
}

/// An option with a value, whose kind is shown as `type`.
template <class Value>
CLI::Option* add_valued(CLI::App* command, const char* name, const char* type, Value& value, const char* help) {
  return command->add_option(name, value, help)->type_name(type);
}

CLI::Option* add_results_file(CLI::App* command, std::filesystem::path& file) {
  return command->add_option("FILE", file, "Results file (HDF5)")->required();
}

// Each function adds a command whose arguments fill the given options.

CLI::App* add(CLI::App& app, RunOptions& run) {
  CLI::App* command = add_command(app, "run", "Runs a job or continues it", with_exit_codes(run_help));
  command->add_option("JOB", run.job, "Job file (JSON)")->required();
  add_valued(command, "-o,--output", "FILE", run.output, "Results file; never overwritten [results/NAME.h5]");
  add_valued(command, "-n,--workers", "N", run.workers,
             "Start this many workers on this machine, by mpirun [1, or the ranks]")
      ->check(CLI::Range(1, 10000));
  CLI::Option* resume = command->add_flag("--resume", run.resume, "Continue the results file if it exists");
  command
      ->add_flag("--retry-failed", run.retry_failed,
                 "With --resume: repeat tasks that ended in an error, timed out or crashed")
      ->needs(resume);
  add_valued(command, "--task-time-limit", "SECONDS", run.task_time_limit_s,
             "Stop tasks that take longer; overrides the job; 0: no limit")
      ->check(not_negative());
  add_valued(command, "--time-limit", "SECONDS", run.time_limit_s,
             "End after this time: start no more tasks, abandon running ones")
      ->check(above_zero());
  add_valued(command, "--memory-limit-gb", "GB", run.memory_limit_gb,
             "Memory per rank; a task that needs more ends in an error [90 % of the host's / its workers]")
      ->check(number_check(0.1, true, "from 0.1 to 1e9"));  // the program itself needs most of 0.1 GB
  add_valued(command, "--max-crashes", "N", run.max_crashes, "Mark a task as crashed after this many worker deaths [3]")
      ->check(CLI::Range(1, 100));
  add_valued(command, "--worker-timeout", "SECONDS", run.worker_timeout_s,
             "Reassign tasks of a worker without heartbeat for this time; 0: no timeout [120]")
      ->check(not_negative());
  const auto shard = [&run](const std::string& text) {
    run.shard = shard_of(text);
    if (!run.shard) throw CLI::ValidationError("--shard", text + " is not allowed; must be I/N with 1 <= I <= N");
  };
  command
      ->add_option_function<std::string>("--shard", shard,
                                         "Run part I of N of the tasks into a separate file, for `merge`")
      ->type_name("I/N");
  add_valued(command, "--extend", "OLD", run.extend, "Reuse the results of a smaller job");
  return command;
}

CLI::App* add(CLI::App& app, PlanOptions& plan) {
  CLI::App* command =
      add_command(app, "plan", "Estimates tasks, bytes and core-hours of a job", with_exit_codes(plan_help));
  command->add_option("JOB", plan.job, "Job file (JSON)")->required();
  command->add_flag_callback(
      "--no-probe", [&plan] { plan.probe = false; }, "Run no tasks, estimate no core-hours");
  add_valued(command, "--workers", "N", plan.workers, "Estimate the time with N workers [one per core of this host]")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--json", plan.json, "Print JSON");
  return command;
}

CLI::App* add(CLI::App& app, ValidateOptions& validate) {
  CLI::App* command = add_command(app, "validate", "Checks jobs without running them", with_exit_codes(validate_help));
  command->add_option("JOB", validate.jobs, "Job files (JSON)")->required();
  command->add_flag("--later", validate.later, "Accept missing models and data sets");
  return command;
}

CLI::App* add(CLI::App& app, StatusOptions& status) {
  CLI::App* command =
      add_command(app, "status", "Shows the progress of a sweep or training", with_exit_codes(status_help));
  add_results_file(command, status.file);
  command->add_flag("--json", status.json, "Print JSON");
  add_valued(command, "--watch", "[SECONDS]", status.watch_s, "Repeat at this interval until the sweep ends")
      ->expected(0, 1)
      ->default_str("5")
      ->check(above_zero());
  return command;
}

CLI::App* add(CLI::App& app, InfoOptions& info) {
  CLI::App* command =
      add_command(app, "info", "Shows the origin of results, and verifies them", with_exit_codes(info_help));
  add_results_file(command, info.file);
  CLI::Option* verify = command->add_flag("--verify", info.verify, "Compare every finished task with its checksum");
  CLI::Option* job = command->add_flag("--job", info.job, "Print only the job, byte for byte");
  CLI::Option* json = command->add_flag("--json", info.json, "Print JSON");
  job->excludes(verify)->excludes(json);
  return command;
}

CLI::App* add(CLI::App& app, RerunOptions& rerun) {
  CLI::App* command = add_command(app, "rerun", "Repeats one task of a sweep and records its trajectory", rerun_help);
  add_results_file(command, rerun.file);
  command->add_option("TASK", rerun.task, "Number of the task, from 0")->required();
  add_valued(command, "-o,--output", "FILE", rerun.output, "Results file; never overwritten [FILE-task-TASK.h5]");
  add_valued(command, "--trajectory-every", "K", rerun.trajectory_every, "Record a frame every K steps [1]")
      ->check(above_zero());
  return command;
}

CLI::App* add(CLI::App& app, SystemsOptions& systems) {
  CLI::App* command =
      add_command(app, "systems", "Repeats one task and writes the linear systems that it solves", systems_help);
  add_results_file(command, systems.file);
  command->add_option("TASK", systems.task, "Number of the task, from 0")->required();
  add_valued(command, "-o,--output", "FILE", systems.output, "New file; never overwritten [FILE-systems-TASK.h5]");
  add_valued(command, "--every", "K", systems.every, "Systems of every Kth step [10]")->check(above_zero());
  command->add_flag("--first", systems.first, "Only those of first Newton iterations");
  return command;
}

CLI::App* add(CLI::App& app, MergeOptions& merge) {
  CLI::App* command = add_command(app, "merge", "Merges results files of the same job", with_exit_codes(merge_help));
  command->add_option("FILE", merge.files, "Results files (HDF5)")->required();
  add_valued(command, "-o,--output", "FILE", merge.output, "Merged file; never overwritten")->required();
  return command;
}

std::string unknown_command_text(const CLI::App& app, const std::string& word) {
  std::vector<std::string> known{"query", "compare", "summary", "report"};
  for (const CLI::App* offered : app.get_subcommands({})) known.push_back(offered->get_name());
  return fmt::format("rodsweep: unknown command \"{}\"; no program rodsweep-{} was found{}{}", word, word,
                     did_you_mean(word, known), help_line);
}

/// The message for an unknown command or option, with a suggestion.
std::string complaint_text(const CLI::App* app, const CLI::Error& error) {
  const auto chosen = app->get_subcommands();
  const CLI::App& command = chosen.empty() ? *app : *chosen.front();
  const std::vector<std::string> words = command.remaining();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr || words.empty())
    return CLI::FailureMessage::simple(app, error);
  const auto is_option = [](const std::string& word) { return word.rfind('-', 0) == 0; };
  const auto option = std::find_if(words.begin(), words.end(), is_option);
  std::vector<std::string> known;
  if (option != words.end()) {
    for (const CLI::Option* offered : command.get_options())
      for (const std::string& name : offered->get_lnames()) known.push_back("--" + name);
    const std::string typed = option->substr(0, option->find('='));
    return fmt::format("rodsweep{}: unknown option {}{}{}", chosen.empty() ? "" : " " + command.get_name(), typed,
                       did_you_mean(typed, known), help_line);
  }
  if (!chosen.empty()) return CLI::FailureMessage::simple(app, error);
  return unknown_command_text(*app, words.front());
}

}  // namespace

Command parse_command_line(int argc, const char* const* argv) {
  CLI::App app(about, "rodsweep");
  app.footer(with_exit_codes(main_help));
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(28);
  app.failure_message(complaint_text);
  bool version = false;
  app.add_flag("--version", version, "Print version, revision and libraries");

  RunOptions run;
  PlanOptions plan;
  RerunOptions rerun;
  SystemsOptions systems;
  run.program = plan.program = rerun.program = argv[0];
  MergeOptions merge;
  run.command = rerun.command = systems.command = merge.command = typed(argc, argv);
  ValidateOptions validate;
  StatusOptions status;
  InfoOptions info;
  std::optional<Command> chosen;
  const auto offer = [&](auto&... options) {
    (add(app, options)->callback([&chosen, &options] { chosen = options; }), ...);
  };
  offer(run, plan, validate, status, info, rerun, systems, merge);

  add_command(app, "schema", "Prints the JSON Schema of jobs, for editors", schema_help)->callback([&] {
    chosen = PrintedText{schema_text()};
  });
  const std::vector<CLI::App*> commands = app.get_subcommands({});
  const std::string first = argc > 1 ? argv[1] : "-";
  if (first[0] != '-' && std::none_of(commands.begin(), commands.end(),
                                      [&](const CLI::App* command) { return command->check_name(first); }))
    return ExternalCommand{first, {argv + 2, argv + argc}, unknown_command_text(app, first)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& stop) {
    std::ostringstream help, complaint;
    const bool mistake = app.exit(stop, help, complaint) != 0;
    return PrintedText{mistake ? complaint.str() : help.str(), mistake ? ExitCode::user_error : ExitCode::ok};
  }
  if (version) return PrintedText{version_text()};
  return chosen.value_or(PrintedText{app.help(), ExitCode::user_error});
}

}  // namespace rodsweep
