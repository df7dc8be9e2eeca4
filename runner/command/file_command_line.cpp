#include "runner/command/file_command_line.hpp"

#include "runner/command/completion.hpp"
#include "runner/job/job_schema.hpp"

namespace rodsweep {
namespace {

constexpr const char* query_footer =
    "A condition is COLUMN, one of = != < <= > >= ~ (contains), and a value; = and != take several values with commas\n"
    "between. All must be met. What is not there (a key of another scene, a result of a pending task) meets none.\n"
    "Columns are keys of the job (scene.segments), state (done, pending), outcome, message, counts and ratios of a\n"
    "guess (cg_ratio.LABEL, at another tolerance cg_ratio.LABEL@1e-4), times (elapsed_s) and more: --columns help.\n"
    "Quote < and > against the shell. Reads only, also while the sweep writes.\n\n"
    "Examples:\n"
    "  rodsweep query results/demo.h5                                  every task: what is swept, outcome, CG ratios\n"
    "  rodsweep query results/demo.h5 state=done 'outcome!=ok' --columns task,outcome,message\n"
    "  rodsweep query results/demo.h5 scene.type=helix 'scene.segments>=75' --sort cg_ratio.quadratic --limit 5\n"
    "  rodsweep query results/demo.h5 --csv >tasks.csv\n"
    "  rodsweep query results/demo.h5 'cg_ratio.previous@1e-4>1' --json | jq '.[].task'\n\n"
    "Exit codes:\n"
    "  0  read, whether tasks were found or not\n"
    "  2  the command line or the file is at fault";

constexpr const char* rerun_footer =
    "The job comes from FILE, so its own file need not be there; relative paths in it begin where it was. The new "
    "file\n"
    "holds one task and is read like any other. Everything that the task wrote outside /timing is compared, bit for "
    "bit.\n"
    "SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 end it between two time steps; then nothing is written.\n\n"
    "Examples:\n"
    "  rodsweep rerun results/demo.h5 12                               every step into results/demo-task-12.h5\n"
    "  rodsweep rerun results/long.h5 3 --trajectory-every 100 -o three.h5\n\n"
    "Exit codes:\n"
    "  0  identical, or there was nothing to compare with\n"
    "  2  the command line or the file is at fault; nothing was written\n"
    "  3  the results differ; or the task failed, and was pending in FILE\n"
    "  4  stopped early; nothing was written";

constexpr const char* pack_footer =
    "Every reader takes the copy for the original, but a sweep cannot be continued in it: keep the original of one "
    "that\n"
    "is not complete. Finished tasks are compared with their checksums before and after. Nothing is overwritten, and\n"
    "the copy gets its name when it is whole.\n\n"
    "Examples:\n"
    "  rodsweep pack results/demo.h5                                   results/demo-packed.h5\n"
    "  rodsweep pack results/demo.h5 -o /archive/demo.h5\n\n"
    "Exit codes:\n"
    "  0  packed\n"
    "  2  the command line or the file is at fault; nothing was written";

constexpr const char* schema_footer =
    "For completion and checks while you type; `rodsweep validate` has the last word. Put the file beside your jobs "
    "and\n"
    "name it in each: \"$schema\": \"schema.json\".\n\n"
    "Example:\n"
    "  rodsweep schema >schema.json";

constexpr const char* completion_footer =
    "Commands, options, job files and results files after the Tab key.\n\n"
    "Example:\n"
    "  source <(rodsweep completion bash)                              in ~/.bashrc";

}  // namespace

FileCommandLine::FileCommandLine(CLI::App& app) : app_(app) {
  add_query();
  add_rerun();
  add_pack();
  schema_command_ = app_.add_subcommand("schema", "Prints the JSON Schema of jobs, for editors");
  schema_command_->footer(schema_footer);
  completion_command_ = app_.add_subcommand("completion", "Prints what a shell needs to complete this command line");
  completion_command_->footer(completion_footer);
  completion_command_->require_subcommand(1);
  completion_command_->add_subcommand("bash", "For bash");
}

void FileCommandLine::add_query() {
  query_command_ = app_.add_subcommand("query", "Lists tasks by parameter or outcome");
  query_command_->footer(query_footer);
  query_command_->add_option("FILE", query_.file, "Results file (HDF5)")->required();
  query_command_->add_option("CONDITION", query_.conditions, "What the tasks must meet");
  query_command_->add_option("--where", where_, "One more condition")->type_name("CONDITION")->allow_extra_args(false);
  query_command_->add_option("--columns", query_.columns, "What to show, with commas between; help: all that there is")
      ->type_name("LIST")
      ->allow_extra_args(false);
  query_command_->add_option("--sort", query_.sort, "Order by a column, smallest first")->type_name("COLUMN");
  query_command_->add_flag("--descending", query_.descending, "Order by it, largest first")->needs("--sort");
  query_command_->add_option("--limit", query_.limit, "Show so many tasks at most")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  auto* csv = query_command_->add_flag("--csv", csv_, "For spreadsheets and programs");
  query_command_->add_flag("--json", json_, "For programs")->excludes(csv);
}

void FileCommandLine::add_rerun() {
  rerun_command_ = app_.add_subcommand("rerun", "Runs one task of a sweep again, with its trajectory");
  rerun_command_->footer(rerun_footer);
  rerun_command_->add_option("FILE", rerun_.file, "Results file (HDF5)")->required();
  rerun_command_->add_option("TASK", rerun_.task, "Number of the task, from 0")->required();
  rerun_command_->add_option("-o,--output", rerun_.output, "Results file; never overwritten [FILE-task-TASK.h5]")
      ->type_name("FILE");
  rerun_command_->add_option("--trajectory-every", rerun_.trajectory_every, "A frame every K steps [1]")
      ->check(CLI::PositiveNumber)
      ->type_name("K");
}

void FileCommandLine::add_pack() {
  pack_command_ = app_.add_subcommand("pack", "Makes a compressed copy of a results file");
  pack_command_->footer(pack_footer);
  pack_command_->add_option("FILE", pack_.file, "Results file (HDF5)")->required();
  pack_command_->add_option("-o,--output", pack_.output, "The copy; never overwritten [FILE-packed.h5]")
      ->type_name("FILE");
}

std::optional<Command> FileCommandLine::chosen(const std::string& line) const {
  if (query_command_->parsed()) {
    QueryOptions query = query_;
    query.conditions.insert(query.conditions.end(), where_.begin(), where_.end());
    if (csv_) query.format = QueryOptions::Format::csv;
    if (json_) query.format = QueryOptions::Format::json;
    return query;
  }
  if (rerun_command_->parsed()) {
    RerunOptions rerun = rerun_;
    rerun.command = line;
    return rerun;
  }
  if (pack_command_->parsed()) return pack_;
  if (schema_command_->parsed()) return Answer{job_schema_text(), ExitCode::ok};
  if (completion_command_->parsed()) return Answer{bash_completion(app_), ExitCode::ok};
  return std::nullopt;
}

}  // namespace rodsweep
