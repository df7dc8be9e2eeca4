#include "runner/command/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

#include "runner/command/command_outline.hpp"
#include "runner/command/completion.hpp"
#include "runner/command/manual.hpp"
#include "runner/job/job_schema.hpp"
#include "runner/job/nearest.hpp"
#include "runner/terminal/text.hpp"

namespace rodsweep {

namespace {

constexpr const char* about =
    "rodsweep: how much does an initial guess save the conjugate-gradient solve of a Cosserat rod simulation?\n"
    "Sweeps of simulations over MPI, one HDF5 file of results per sweep.";

constexpr const char* exit_codes =
    "Exit codes:\n"
    "  0  all done\n"
    "  2  the command line, a job or a file is at fault; nothing of yours was changed\n"
    "  3  the sweep is complete, some of its tasks failed; or a training diverged\n"
    "  4  stopped early; --resume continues\n"
    "  5  likewise, but what is left needs a longer --time-limit\n"
    "  6  no worker was left; --resume continues";

constexpr const char* main_help =
    "Examples:\n"
    "  rodsweep validate jobs/demo.json         is this job sound?\n"
    "  rodsweep plan jobs/demo.json             how many tasks, bytes, core-hours?\n"
    "  mpirun -n 9 rodsweep run jobs/demo.json  8 workers and a master, which sleeps\n"
    "  rodsweep keep -- mpirun -n 9 rodsweep run jobs/demo.json\n"
    "                                           again and again until it is done, whatever dies\n"
    "  rodsweep status results/demo.h5          how far is it? (also while it runs)\n"
    "  rodsweep query results/demo.h5           its tasks as a table, CSV or JSON\n"
    "  rodsweep compare before.h5 after.h5      what differs between two sweeps\n"
    "'rodsweep COMMAND --help' tells more.";

constexpr const char* schema_help =
    "For completion and checks while you type; `rodsweep validate` has the last word. Put the file beside your jobs "
    "and\n"
    "name it in each: \"$schema\": \"schema.json\".\n\n"
    "Example:\n"
    "  rodsweep schema >schema.json";

constexpr const char* completion_help =
    "Commands, options, job files and results files after the Tab key. `make install` puts all three where the shells\n"
    "look for them; without:\n\n"
    "  source <(rodsweep completion bash)                              in ~/.bashrc\n"
    "  source <(rodsweep completion zsh)                               in ~/.zshrc, after compinit\n"
    "  rodsweep completion fish >~/.config/fish/completions/rodsweep.fish";

constexpr const char* manual_help =
    "In the language of man(7), with all that the commands' own --help says.\n\n"
    "Example:\n"
    "  rodsweep manual | man -l -";

std::string with_exit_codes(const char* help) { return std::string(help) + "\n\n" + exit_codes; }

std::string typed(int argc, const char* const* argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) line += (i > 0 ? " " : "") + shell_quoted(argv[i]);
  return line;
}

/// "rodsweep 1.0.0 (revision ...)" and the libraries, a line each.
std::string version_text() {
  std::string text = library_versions() + '\n';
  for (std::size_t at = text.find("; "); at != std::string::npos; at = text.find("; ", at)) text.replace(at, 2, "\n  ");
  return text.insert(text.find('\n'), " (revision " + source_revision() + ")");
}

// CLI11's own name the largest double.
CLI::Validator number_check(bool zero, const char* bound) {
  return CLI::Validator(
      [zero, bound](std::string& text) {
        double value = 0;
        constexpr double most = 1e9;  // also of what is no number
        const bool good =
            CLI::detail::lexical_cast(text, value) && value <= most && (value > 0 || (zero && value == 0));
        return good ? std::string() : fmt::format("{} is not a number {}", text, bound);
      },
      "");
}
CLI::Validator above_zero() { return number_check(false, "above 0 and up to 1e9"); }
CLI::Validator not_negative() { return number_check(true, "from 0 to 1e9"); }

// Each adds a command, whose arguments fill the options given.

CLI::App* add(CLI::App& app, RunOptions& run) {
  CLI::App* command = app.add_subcommand("run", "Runs a job, or goes on with it");
  command->footer(with_exit_codes(run_help));
  command->add_option("JOB", run.job, "Job file (JSON)")->required();
  command->add_option("-o,--output", run.output, "Results file; never overwritten [results/NAME.h5]")
      ->type_name("FILE");
  CLI::Option* resume = command->add_flag("--resume", run.resume, "Continue the results file if it exists");
  command
      ->add_flag("--retry-failed", run.retry_failed,
                 "With --resume: run tasks again that ended in an error, timed out or crashed")
      ->needs(resume);
  command
      ->add_option("--task-time-limit", run.task_time_limit_s,
                   "Give up tasks that take longer, whatever the job says; 0: no limit")
      ->check(not_negative())
      ->type_name("SECONDS");
  command
      ->add_option("--time-limit", run.time_limit_s,
                   "Be done by then: begin no task that would take longer, abandon what runs")
      ->check(above_zero())
      ->type_name("SECONDS");
  command
      ->add_option("--time-passed", run.time_passed_s, "So much of it is over already (keep says it to later starts)")
      ->check(not_negative())
      ->type_name("SECONDS");
  command
      ->add_option("--memory-limit-gb", run.memory_limit_gb,
                   "Memory of a rank; a task that wants more is an error [an equal share of nine tenths of the host's]")
      ->check(CLI::Range(0.1, 1e9))  // the program itself has most of that
      ->type_name("GB");
  command->add_option("--attempts", run.attempts, "Set a task aside as crashed that ended so many workers [3]")
      ->check(CLI::Range(1, 100))
      ->type_name("N");
  command
      ->add_option("--worker-timeout", run.worker_timeout_s,
                   "Go on without a worker that was silent for so long; 0: wait for ever [120]")
      ->check(not_negative())
      ->type_name("SECONDS");
  command
      ->add_option_function<std::string>(
          "--shard",
          [&run](const std::string& text) {
            run.shard = shard_of(text);
            if (!run.shard) throw CLI::ValidationError("--shard", text + " is no I/N with 1 <= I <= N");
          },
          "Run the I-th of N parts of the tasks, into a file of its own, for `merge`")
      ->type_name("I/N");
  command->add_option("--extend", run.extend, "Take over what these results of a smaller job hold")->type_name("OLD");
  return command;
}

CLI::App* add(CLI::App& app, PlanOptions& plan) {
  CLI::App* command = app.add_subcommand("plan", "Says what a job takes: tasks, bytes, core-hours");
  command->footer(with_exit_codes(plan_help));
  command->add_option("JOB", plan.job, "Job file (JSON)")->required();
  command->add_flag_callback(
      "--no-probe", [&plan] { plan.probe = false; }, "Run nothing, so tell no core-hours");
  command->add_option("--workers", plan.workers, "Tell the time for so many workers [one for each core here]")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  command->add_flag("--json", plan.json, "For programs");
  return command;
}

CLI::App* add(CLI::App& app, ValidateOptions& validate) {
  CLI::App* command = app.add_subcommand("validate", "Checks jobs without running them");
  command->footer(with_exit_codes(validate_help));
  command->add_option("JOB", validate.jobs, "Job files (JSON)")->required();
  command->add_flag("--later", validate.later, "Pass models and data sets that are not there yet");
  return command;
}

CLI::App* add(CLI::App& app, StatusOptions& status) {
  CLI::App* command = app.add_subcommand("status", "Says how far a sweep is");
  command->footer(with_exit_codes(status_help));
  command->add_option("FILE", status.file, "Results file (HDF5)")->required();
  command->add_flag("--json", status.json, "For programs");
  command->add_option("--watch", status.watch_s, "Say it again every so many seconds, until the sweep ends")
      ->expected(0, 1)
      ->default_str("5")
      ->check(above_zero())
      ->type_name("[SECONDS]");
  return command;
}

CLI::App* add(CLI::App& app, InfoOptions& info) {
  CLI::App* command = app.add_subcommand("info", "Says where results come from, and checks them");
  command->footer(with_exit_codes(info_help));
  command->add_option("FILE", info.file, "Results file (HDF5)")->required();
  CLI::Option* verify = command->add_flag("--verify", info.verify, "Compare every finished task with its checksum");
  CLI::Option* job = command->add_flag("--job", info.job, "Print the job alone, byte for byte");
  CLI::Option* json = command->add_flag("--json", info.json, "For programs");
  job->excludes(verify)->excludes(json);
  return command;
}

CLI::App* add(CLI::App& app, QueryOptions& query) {
  CLI::App* command = app.add_subcommand("query", "Lists tasks by parameter or outcome");
  command->footer(query_help);
  command->add_option("FILE", query.file, "Results file (HDF5)")->required();
  command->add_option("CONDITION", query.conditions, "What the tasks must meet");
  const auto append = [&query](const std::vector<std::string>& more) {  // comes after CONDITION
    query.conditions.insert(query.conditions.end(), more.begin(), more.end());
  };
  command->add_option_function<std::vector<std::string>>("--where", append, "One more condition")
      ->type_name("CONDITION")
      ->allow_extra_args(false);
  command->add_option("--columns", query.columns, "What to show, with commas between; help: all that there is")
      ->type_name("LIST")
      ->allow_extra_args(false);
  command->add_option("--sort", query.sort, "Order by a column, smallest first")->type_name("COLUMN");
  command->add_flag("--descending", query.descending, "Order by it, largest first")->needs("--sort");
  command->add_option("--limit", query.limit, "Show so many tasks at most")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  using Format = QueryOptions::Format;
  const auto set = [&query](Format format) { return [&query, format] { query.format = format; }; };
  CLI::Option* csv = command->add_flag_callback("--csv", set(Format::csv), "For spreadsheets and programs");
  command->add_flag_callback("--json", set(Format::json), "For programs")->excludes(csv);
  return command;
}

CLI::App* add(CLI::App& app, CompareOptions& compare) {
  CLI::App* command = app.add_subcommand("compare", "Says what differs between two sweeps");
  command->footer(compare_help);
  command->add_option("FILE", compare.a, "Results file (HDF5)")->required();
  command->add_option("OTHER", compare.b, "Another")->required();
  const std::map<std::string, MatchBy> by{{"everything", MatchBy::everything}, {"parameters", MatchBy::parameters}};
  command->add_option("--by", compare.by, "What makes two tasks the same: everything, or what varies within a job")
      ->transform(CLI::CheckedTransformer(by).description(""))
      ->type_name("everything|parameters");
  command->add_flag("--tasks", compare.tasks, "List every task that differs");
  using Format = CompareOptions::Format;
  const auto set = [&compare](Format format) { return [&compare, format] { compare.format = format; }; };
  CLI::Option* csv = command->add_flag_callback("--csv", set(Format::csv), "For spreadsheets and programs");
  command->add_flag_callback("--json", set(Format::json), "For programs")->excludes(csv);
  return command;
}

CLI::App* add(CLI::App& app, RerunOptions& rerun) {
  CLI::App* command = app.add_subcommand("rerun", "Runs one task of a sweep again, with its trajectory");
  command->footer(rerun_help);
  command->add_option("FILE", rerun.file, "Results file (HDF5)")->required();
  command->add_option("TASK", rerun.task, "Number of the task, from 0")->required();
  command->add_option("-o,--output", rerun.output, "Results file; never overwritten [FILE-task-TASK.h5]")
      ->type_name("FILE");
  command->add_option("--trajectory-every", rerun.trajectory_every, "A frame every K steps [1]")
      ->check(above_zero())
      ->type_name("K");
  return command;
}

CLI::App* add(CLI::App& app, PackOptions& pack) {
  CLI::App* command = app.add_subcommand("pack", "Makes a compressed copy of a results file");
  command->footer(pack_help);
  command->add_option("FILE", pack.file, "Results file (HDF5)")->required();
  command->add_option("-o,--output", pack.output, "The copy; never overwritten [FILE-packed.h5]")->type_name("FILE");
  return command;
}

CLI::App* add(CLI::App& app, MergeOptions& merge) {
  CLI::App* command = app.add_subcommand("merge", "Makes one results file of several of the same job");
  command->footer(with_exit_codes(merge_help));
  command->add_option("FILE", merge.files, "Results files (HDF5)")->required();
  command->add_option("-o,--output", merge.output, "The file of all; never overwritten")->type_name("FILE")->required();
  return command;
}

CLI::App* add(CLI::App& app, KeepOptions& keep) {
  CLI::App* command = app.add_subcommand("keep", "Starts a run again, whatever ends it, until it is done");
  command->footer(with_exit_codes(keep_help));
  command->add_option("COMMAND", keep.command, "After --: the run, as it would be typed, with mpirun")->required();
  command->add_option("--hosts", keep.hosts, "Start on the hosts of this file that answer: {hosts} in COMMAND")
      ->type_name("HOSTS");
  command
      ->add_option("--silence", keep.silence_s,
                   "End a start that shows no sign of life for so long, a training's ten times; 0: never [300]")
      ->check(not_negative())
      ->type_name("SECONDS");
  command->add_option("--pause", keep.pause_s, "Before the next start; doubles while nothing gets done [1]")
      ->check(above_zero())
      ->type_name("SECONDS");
  command->add_option("--vain-starts", keep.vain_starts, "Give up after so many in a row that get nothing done [10]")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  return command;
}

/// What is said of words that are no command and no option: what may have been meant.
std::string complaint_text(const CLI::App* app, const CLI::Error& error) {
  const std::string more = "\nRun with --help for more information.\n";
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
    return fmt::format("rodsweep{}: there is no option {}{}{}", chosen.empty() ? "" : " " + command.get_name(), typed,
                       did_you_mean(typed, known), more);
  }
  if (!chosen.empty()) return CLI::FailureMessage::simple(app, error);
  for (const CLI::App* offered : app->get_subcommands({})) known.push_back(offered->get_name());
  return fmt::format("rodsweep: there is no command \"{}\"{}{}", words.front(), did_you_mean(words.front(), known),
                     more);
}

/// The run that is kept, understood like one that is typed. Not one: an Answer that says why.
Command with_its_run(KeepOptions keep) {
  const std::vector<std::string> words = run_words(keep.command);
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  Command inner = words.empty() ? Command(Answer{"there is no 'rodsweep run JOB' in it\n", ExitCode::user_error})
                                : parse_command_line(static_cast<int>(pointers.size()), pointers.data());
  if (auto* run = std::get_if<RunOptions>(&inner)) {
    keep.run = std::move(*run);
    return keep;
  }
  const auto* answer = std::get_if<Answer>(&inner);
  return Answer{fmt::format("rodsweep keep: the command behind -- is not a run to keep: {}",
                            answer != nullptr ? answer->text : "\n"),
                ExitCode::user_error};
}

}  // namespace

Command parse_command_line(int argc, const char* const* argv) {
  CLI::App app(about, "rodsweep");
  app.footer(with_exit_codes(main_help));
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(28);
  app.failure_message(complaint_text);
  bool version = false;
  app.add_flag("--version", version, "Version, revision and libraries");

  RunOptions run;
  PlanOptions plan;
  RerunOptions rerun;
  run.program = plan.program = argv[0];
  MergeOptions merge;
  run.command = rerun.command = merge.command = typed(argc, argv);
  ValidateOptions validate;
  StatusOptions status;
  InfoOptions info;
  QueryOptions query;
  CompareOptions compare;
  PackOptions pack;
  KeepOptions keep;
  std::optional<Command> chosen;
  const auto offer = [&](auto&... options) {
    (add(app, options)->callback([&chosen, &options] { chosen = options; }), ...);
  };
  offer(run, keep, plan, validate, status, info, query, compare, rerun, pack, merge);

  CLI::App* schema = app.add_subcommand("schema", "Prints the JSON Schema of jobs, for editors");
  schema->footer(schema_help);
  schema->callback([&] { chosen = Answer{job_schema_text()}; });
  CLI::App* completion = app.add_subcommand("completion", "Prints what a shell needs to complete this command line");
  completion->footer(completion_help);
  completion->require_subcommand(1);
  using Script = std::string(const CommandOutline&);
  const auto offer_shell = [&](const char* shell, Script* script) {
    completion->add_subcommand(shell, fmt::format("For {}", shell))->callback([&chosen, &app, script] {
      chosen = Answer{script(outline_of(app))};
    });
  };
  offer_shell("bash", bash_completion);
  offer_shell("zsh", zsh_completion);
  offer_shell("fish", fish_completion);
  CLI::App* manual = app.add_subcommand("manual", "Prints the manual page");
  manual->footer(manual_help);
  manual->callback([&] {
    const std::string versions = library_versions();
    chosen = Answer{manual_page(outline_of(app), versions.substr(0, versions.find(';')))};
  });

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& stop) {
    std::ostringstream help, complaint;
    const bool mistake = app.exit(stop, help, complaint) != 0;
    return Answer{mistake ? complaint.str() : help.str(), mistake ? ExitCode::user_error : ExitCode::ok};
  }
  if (version) return Answer{version_text()};
  if (chosen && std::holds_alternative<KeepOptions>(*chosen)) return with_its_run(std::get<KeepOptions>(*chosen));
  return chosen.value_or(Answer{app.help(), ExitCode::user_error});
}

}  // namespace rodsweep
