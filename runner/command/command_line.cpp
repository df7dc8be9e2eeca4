#include "runner/command/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <sstream>

#include "runner/file/reader_constants.hpp"
#include "runner/keys/job_schema.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/text/nearest.hpp"

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

// Each function adds a command whose arguments fill the given options.

CLI::App* add(CLI::App& app, RunOptions& run) {
  CLI::App* command = app.add_subcommand("run", "Runs a job or continues it");
  command->footer(with_exit_codes(run_help));
  command->add_option("JOB", run.job, "Job file (JSON)")->required();
  command->add_option("-o,--output", run.output, "Results file; never overwritten [results/NAME.h5]")
      ->type_name("FILE");
  command
      ->add_option("-n,--workers", run.workers, "Start this many workers on this machine, by mpirun [1, or the ranks]")
      ->check(CLI::Range(1, 10000))
      ->type_name("N");
  CLI::Option* resume = command->add_flag("--resume", run.resume, "Continue the results file if it exists");
  command
      ->add_flag("--retry-failed", run.retry_failed,
                 "With --resume: repeat tasks that ended in an error, timed out or crashed")
      ->needs(resume);
  command
      ->add_option("--task-time-limit", run.task_time_limit_s,
                   "Stop tasks that take longer; overrides the job; 0: no limit")
      ->check(not_negative())
      ->type_name("SECONDS");
  command
      ->add_option("--time-limit", run.time_limit_s, "End after this time: start no more tasks, abandon running ones")
      ->check(above_zero())
      ->type_name("SECONDS");
  command
      ->add_option("--memory-limit-gb", run.memory_limit_gb,
                   "Memory per rank; a task that needs more ends in an error [90 % of the host's / its workers]")
      ->check(number_check(0.1, true, "from 0.1 to 1e9"))  // the program itself needs most of 0.1 GB
      ->type_name("GB");
  command->add_option("--max-crashes", run.max_crashes, "Mark a task as crashed after this many worker deaths [3]")
      ->check(CLI::Range(1, 100))
      ->type_name("N");
  command
      ->add_option("--worker-timeout", run.worker_timeout_s,
                   "Reassign tasks of a worker without heartbeat for this time; 0: no timeout [120]")
      ->check(not_negative())
      ->type_name("SECONDS");
  command
      ->add_option_function<std::string>(
          "--shard",
          [&run](const std::string& text) {
            run.shard = shard_of(text);
            if (!run.shard)
              throw CLI::ValidationError("--shard", text + " is not allowed; must be I/N with 1 <= I <= N");
          },
          "Run part I of N of the tasks into a separate file, for `merge`")
      ->type_name("I/N");
  command->add_option("--extend", run.extend, "Reuse the results of a smaller job")->type_name("OLD");
  return command;
}

CLI::App* add(CLI::App& app, PlanOptions& plan) {
  CLI::App* command = app.add_subcommand("plan", "Estimates tasks, bytes and core-hours of a job");
  command->footer(with_exit_codes(plan_help));
  command->add_option("JOB", plan.job, "Job file (JSON)")->required();
  command->add_flag_callback(
      "--no-probe", [&plan] { plan.probe = false; }, "Run no tasks, estimate no core-hours");
  command->add_option("--workers", plan.workers, "Estimate the time with N workers [one per core of this host]")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  command->add_flag("--json", plan.json, "Print JSON");
  return command;
}

CLI::App* add(CLI::App& app, ValidateOptions& validate) {
  CLI::App* command = app.add_subcommand("validate", "Checks jobs without running them");
  command->footer(with_exit_codes(validate_help));
  command->add_option("JOB", validate.jobs, "Job files (JSON)")->required();
  command->add_flag("--later", validate.later, "Accept missing models and data sets");
  return command;
}

CLI::App* add(CLI::App& app, StatusOptions& status) {
  CLI::App* command = app.add_subcommand("status", "Shows the progress of a sweep or training");
  command->footer(with_exit_codes(status_help));
  command->add_option("FILE", status.file, "Results file (HDF5)")->required();
  command->add_flag("--json", status.json, "Print JSON");
  command->add_option("--watch", status.watch_s, "Repeat at this interval until the sweep ends")
      ->expected(0, 1)
      ->default_str("5")
      ->check(above_zero())
      ->type_name("[SECONDS]");
  return command;
}

CLI::App* add(CLI::App& app, InfoOptions& info) {
  CLI::App* command = app.add_subcommand("info", "Shows the origin of results, and verifies them");
  command->footer(with_exit_codes(info_help));
  command->add_option("FILE", info.file, "Results file (HDF5)")->required();
  CLI::Option* verify = command->add_flag("--verify", info.verify, "Compare every finished task with its checksum");
  CLI::Option* job = command->add_flag("--job", info.job, "Print only the job, byte for byte");
  CLI::Option* json = command->add_flag("--json", info.json, "Print JSON");
  job->excludes(verify)->excludes(json);
  return command;
}

CLI::App* add(CLI::App& app, RerunOptions& rerun) {
  CLI::App* command = app.add_subcommand("rerun", "Repeats one task of a sweep and records its trajectory");
  command->footer(rerun_help);
  command->add_option("FILE", rerun.file, "Results file (HDF5)")->required();
  command->add_option("TASK", rerun.task, "Number of the task, from 0")->required();
  command->add_option("-o,--output", rerun.output, "Results file; never overwritten [FILE-task-TASK.h5]")
      ->type_name("FILE");
  command->add_option("--trajectory-every", rerun.trajectory_every, "Record a frame every K steps [1]")
      ->check(above_zero())
      ->type_name("K");
  return command;
}

CLI::App* add(CLI::App& app, SystemsOptions& systems) {
  CLI::App* command = app.add_subcommand("systems", "Repeats one task and writes the linear systems that it solves");
  command->footer(systems_help);
  command->add_option("FILE", systems.file, "Results file (HDF5)")->required();
  command->add_option("TASK", systems.task, "Number of the task, from 0")->required();
  command->add_option("-o,--output", systems.output, "New file; never overwritten [FILE-systems-TASK.h5]")
      ->type_name("FILE");
  command->add_option("--every", systems.every, "Systems of every Kth step [10]")->check(above_zero())->type_name("K");
  command->add_flag("--first", systems.first, "Only those of first Newton iterations");
  return command;
}

CLI::App* add(CLI::App& app, MergeOptions& merge) {
  CLI::App* command = app.add_subcommand("merge", "Merges results files of the same job");
  command->footer(with_exit_codes(merge_help));
  command->add_option("FILE", merge.files, "Results files (HDF5)")->required();
  command->add_option("-o,--output", merge.output, "Merged file; never overwritten")->type_name("FILE")->required();
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

  CLI::App* schema = app.add_subcommand("schema", "Prints the JSON Schema of jobs, for editors");
  schema->footer(schema_help);
  schema->callback([&] { chosen = PrintedText{job_schema_text({{"x-files", reader_constants()}})}; });
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
