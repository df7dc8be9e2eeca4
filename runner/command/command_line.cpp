#include "runner/command/command_line.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>

#include "runner/command/file_command_line.hpp"
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
    "  4  stopped early; --resume continues";

constexpr const char* main_footer =
    "Examples:\n"
    "  rodsweep validate jobs/*.json            are these jobs sound?\n"
    "  rodsweep plan jobs/demo.json             how many tasks, bytes, core-hours?\n"
    "  mpirun -n 9 rodsweep run jobs/demo.json  8 workers and a master, which sleeps\n"
    "  rodsweep status results/demo.h5          how far is it? (also while it runs)\n"
    "  rodsweep query results/demo.h5           its tasks as a table, CSV or JSON\n"
    "'rodsweep COMMAND --help' tells more.";

constexpr const char* run_footer =
    "One rank runs the tasks itself; of more, rank 0 hands them out and sleeps, so C cores want C+1 ranks.\n"
    "Open MPI refuses more ranks than cores unless told --oversubscribe; inside containers as root it also\n"
    "wants --allow-run-as-root.\n"
    "A training (kind \"train\") has no master: C cores want C ranks, at most as many as training.shards.\n\n"
    "SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 stop the sweep between two time steps: running tasks are abandoned,\n"
    "finished ones are in the file. mpirun hands SIGUSR1 on to all ranks and then exits 4 as well. On SIGTERM and\n"
    "SIGINT it kills what still runs a second later, and itself exits 1. However a sweep ended, it can be resumed.\n"
    "A training stops between two steps and goes on from there, to the same bits.\n\n"
    "Examples:\n"
    "  rodsweep run jobs/smoke.json                        one core, results/smoke.h5\n"
    "  mpirun --oversubscribe -n 5 rodsweep run job.json   4 cores\n"
    "  mpirun -n 5 rodsweep run job.json -o out.h5 --resume\n"
    "                                                      continues out.h5, or starts it: for batch scripts\n"
    "  rodsweep run more.json -o more.h5 --extend out.h5   more.json: job.json with more samples, more values in a\n"
    "                                                      grid, or more guesses. Copies what out.h5 holds, tries\n"
    "                                                      new guesses alone on its trajectories, runs the rest.\n"
    "                                                      out.h5 is read only; more.h5 is as if run from scratch.";

constexpr const char* plan_footer =
    "Up to three tasks (cheapest, median, dearest), or some steps of a training, are really run for a moment, unless\n"
    "--no-probe is given. A training's data set must be there.\n\n"
    "Example:\n"
    "  rodsweep plan jobs/spatial_bending.json";

constexpr const char* validate_footer =
    "Every job is expanded in full, so what passes here is accepted by run. Nothing is computed or written.\n\n"
    "Example:\n"
    "  rodsweep validate jobs/*.json";

constexpr const char* status_footer =
    "Reads only, also while the sweep writes. The exit code is 0 whatever the state: scripts read --json.\n\n"
    "Example:\n"
    "  rodsweep status results/demo.h5 --json | jq .pending";

constexpr const char* info_footer =
    "Examples:\n"
    "  rodsweep info results/demo.h5                     job, axes, and every start with its versions\n"
    "  rodsweep info results/demo.h5 --verify            are the data still what was written? (checksums)\n"
    "  rodsweep info results/demo.h5 --job > again.json  the job, as it was given";

std::string with_exit_codes(const char* footer) { return std::string(footer) + "\n\n" + exit_codes; }

std::string typed(int argc, const char* const* argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) line += (i > 0 ? " " : "") + shell_quoted(argv[i]);
  return line;
}

}  // namespace

Command parse_command_line(int argc, const char* const* argv) {
  CLI::App app(about, "rodsweep");
  app.footer(with_exit_codes(main_footer));
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(28);
  bool version = false;
  app.add_flag("--version", version, "Version, revision and libraries");

  RunOptions run;
  auto* run_command = app.add_subcommand("run", "Runs a job, or goes on with it");
  run_command->footer(with_exit_codes(run_footer));
  run_command->add_option("JOB", run.job, "Job file (JSON)")->required();
  run_command->add_option("-o,--output", run.output, "Results file; never overwritten [results/NAME.h5]")
      ->type_name("FILE");
  run_command->add_flag("--resume", run.resume, "Continue the results file if it exists");
  run_command->add_option("--extend", run.extend, "Take over what these results of a smaller job hold")
      ->type_name("OLD");

  PlanOptions plan;
  bool no_probe = false;
  auto* plan_command = app.add_subcommand("plan", "Says what a job takes: tasks, bytes, core-hours");
  plan_command->footer(with_exit_codes(plan_footer));
  plan_command->add_option("JOB", plan.job, "Job file (JSON)")->required();
  plan_command->add_flag("--no-probe", no_probe, "Run nothing, so tell no core-hours");
  plan_command->add_flag("--json", plan.json, "For programs");

  ValidateOptions validate;
  auto* validate_command = app.add_subcommand("validate", "Checks jobs without running them");
  validate_command->footer(with_exit_codes(validate_footer));
  validate_command->add_option("JOB", validate.jobs, "Job files (JSON)")->required();

  StatusOptions status;
  auto* status_command = app.add_subcommand("status", "Says how far a sweep is");
  status_command->footer(with_exit_codes(status_footer));
  status_command->add_option("FILE", status.file, "Results file (HDF5)")->required();
  status_command->add_flag("--json", status.json, "For programs");

  InfoOptions info;
  auto* info_command = app.add_subcommand("info", "Says where results come from, and checks them");
  info_command->footer(with_exit_codes(info_footer));
  info_command->add_option("FILE", info.file, "Results file (HDF5)")->required();
  auto* verify = info_command->add_flag("--verify", info.verify, "Compare every finished task with its checksum");
  auto* job = info_command->add_flag("--job", info.job, "Print the job alone, byte for byte");
  auto* json = info_command->add_flag("--json", info.json, "For programs");
  job->excludes(verify)->excludes(json);
  const FileCommandLine file_commands(app);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& stop) {
    std::ostringstream help, complaint;
    const bool mistake = app.exit(stop, help, complaint) != 0;
    return Answer{mistake ? complaint.str() : help.str(), mistake ? ExitCode::user_error : ExitCode::ok};
  }

  if (version) return VersionOptions{};
  if (run_command->parsed()) {
    run.program = argv[0];
    run.command = typed(argc, argv);
    return run;
  }
  if (plan_command->parsed()) {
    plan.program = argv[0];
    plan.probe = !no_probe;
    return plan;
  }
  if (validate_command->parsed()) return validate;
  if (status_command->parsed()) return status;
  if (info_command->parsed()) return info;
  if (auto chosen = file_commands.chosen(typed(argc, argv))) return *std::move(chosen);
  return Answer{app.help(), ExitCode::user_error};
}

}  // namespace rodsweep
