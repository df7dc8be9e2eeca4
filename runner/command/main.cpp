// The program. Parses, starts MPI and PETSc where a command needs them, reports what went wrong, and exits.
//
// An error that all ranks share (a bad job, an existing file) is said once and ends all of them with exit code 2. An
// error of one rank alone (a full disk) is said by that rank, which then aborts the others: they would wait for it for
// ever.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "runner/command/command_line.hpp"
#include "runner/command/file_commands.hpp"
#include "runner/command/plan_command.hpp"
#include "runner/command/shared_job.hpp"
#include "runner/command/sweep_run.hpp"
#include "runner/command/training_run.hpp"
#include "runner/file/provenance.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/console.hpp"
#include "solver/linear/petsc_session.hpp"

namespace rodsweep {

namespace {

/// Under mpirun or srun every rank gets the command; one should speak.
bool is_first_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK"})
    if (const char* rank = std::getenv(name)) return std::atoi(rank) == 0;
  return true;
}

ExitCode execute(const Answer& answer, Console& console) {
  if (answer.code == ExitCode::ok)
    console.raw_result(answer.text);
  else
    console.raw_error(answer.text);
  return answer.code;
}

ExitCode execute(const VersionOptions&, Console& console) { return show_version(console); }
ExitCode execute(const ValidateOptions& options, Console& console) { return validate_jobs(options, console); }
ExitCode execute(const StatusOptions& options, Console& console) { return show_status(options, console); }
ExitCode execute(const InfoOptions& options, Console& console) { return show_info(options, console); }

ExitCode execute(const QueryOptions& options, Console& console) { return query_tasks(options, console); }

ExitCode execute(const PackOptions& options, Console& console) {
  return is_first_rank() ? pack_file(options, console) : ExitCode::ok;  // one should write
}

ExitCode execute(const RerunOptions& options, Console& console) {
  const MpiSession mpi;
  const PetscSession petsc;
  if (mpi.rank() > 0) return ExitCode::ok;
  return rerun_task(options, console);
}

ExitCode execute(const PlanOptions& options, Console& console) {
  if (!options.probe) return show_plan(options, console);
  const MpiSession mpi;
  const PetscSession petsc;
  if (mpi.rank() > 0) return ExitCode::ok;
  return show_plan(options, console);
}

ExitCode execute(const RunOptions& options, Console& console) {
  const MpiSession mpi;
  try {
    const PetscSession petsc;
    const Job job = read_job_everywhere(options.job, mpi);
    return is_training(job) ? run_training(options, job, mpi, console) : run_sweep(options, job, mpi, console);
  } catch (const CollectiveError& error) {
    console.error(error.what());
    return ExitCode::user_error;
  } catch (const std::exception& error) {
    fmt::print(stderr, "rodsweep: error: rank {} on {} cannot go on: {}\n", mpi.rank(), host_name(), error.what());
    fmt::print(stderr, "rodsweep: what was finished is in the file; once the cause is gone, --resume continues\n");
    std::fflush(nullptr);
    MPI_Abort(mpi.world(), static_cast<int>(ExitCode::user_error));
    std::abort();
  }
}

}  // namespace

}  // namespace rodsweep

int main(int argc, char** argv) {
  using namespace rodsweep;
  Console console(is_first_rank());
  try {
    const Command command = parse_command_line(argc, argv);
    const ExitCode code = std::visit([&](const auto& options) { return execute(options, console); }, command);
    return static_cast<int>(code);
  } catch (const std::exception& error) {
    console.error(error.what());
    return static_cast<int>(ExitCode::user_error);
  }
}
