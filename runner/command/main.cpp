// The program: parses the command line, starts MPI and PETSc if the command needs them, reports errors, exits.
//
// An error on all ranks (a bad job, an existing file) is printed once; all ranks exit.
// An error on one rank (a full disk) is printed by that rank. It then calls MPI_Abort, because the other ranks would
// wait for it forever. The file keeps every finished task.
// A failed write to stdout (a full disk, a closed descriptor) is an error, but the command runs to its end.
// If the reader closed stdout (`| head`), the program ends with SIGPIPE, without a message.
#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "runner/command/commands.hpp"
#include "runner/command/process_end.hpp"
#include "runner/command/run_command.hpp"
#include "runner/file/file_error.hpp"
#include "runner/file/provenance.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/console.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/linear/interruption.hpp"
#include "solver/plugin/user_call.hpp"

namespace rodsweep {

namespace {

/// Opens closed standard descriptors. Otherwise the next file opened, such as a results file, gets that descriptor and
/// receives printed text. The inverted access mode makes reads and writes fail instead.
void occupy_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0) open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/// Without HOME and an entry in passwd, as in some containers, mpirun and MPI_Init crash (PMIx 4.2).
void provide_home() {
  if (getpwuid(getuid()) == nullptr) setenv("HOME", "/", 0);
}

/// Under mpirun or srun every rank runs the command, but only one should print.
bool is_first_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK"})
    if (const char* rank = std::getenv(name)) return std::atoi(rank) == 0;
  return true;
}

/// After a failed write HDF5 would crash in MPI_Finalize: prints the error and exits immediately.
void leave_if_broken(const MpiSession& mpi, const std::exception& error, Console& console) {
  if (!hdf5_is_broken()) return;
  console.error(error.what());
  std::fflush(nullptr);
  process_ends();
  if (mpi.size() > 1) MPI_Abort(mpi.world(), static_cast<int>(ExitCode::user_error));
  leave(ExitCode::user_error);
}

constexpr const char* kept = ". Finished tasks are kept, and --resume continues";

void warn_of_long_call() {
  static std::atomic<bool> is_told{false};
  if (!is_told.exchange(true))
    Console(true).warn(fmt::format("{} has not returned for a minute; --task-time-limit ends such tasks", user_code()));
}

/// Ends the only rank of a run. Where there are others, its heartbeats end, and they do without it.
void leave_stuck() {
  fmt::print(stderr,
             "rodsweep: error: {} has not returned, a minute after a time limit or a signal; it must end by itself{}\n",
             user_code(), kept);
  leave(ExitCode::stopped);
}

/// Runs a command on rank 0. All ranks start MPI, because MPI_Init is collective.
template <class Options>
ExitCode execute_with_petsc(const Options& options, Console& console) {
  const MpiSession mpi;
  const PetscSession petsc;
  try {
    return mpi.rank() == 0 ? execute(options, console) : ExitCode::ok;
  } catch (const std::exception& error) {
    leave_if_broken(mpi, error, console);
    throw;
  }
}

/// Runs a command without MPI on the first rank only.
template <class Options>
ExitCode start(const Options& options, Console& console) {
  return is_first_rank() ? execute(options, console) : ExitCode::ok;
}

ExitCode start(const RerunOptions& options, Console& console) { return execute_with_petsc(options, console); }

ExitCode start(const SystemsOptions& options, Console& console) { return execute_with_petsc(options, console); }

ExitCode start(const MergeOptions& options, Console& console) { return execute_with_petsc(options, console); }

ExitCode start(const PlanOptions& options, Console& console) {
  return options.probe ? execute_with_petsc(options, console) : start<PlanOptions>(options, console);
}

ExitCode start(const PrintedText& answer, Console& console) {
  if (answer.code == ExitCode::ok)
    console.raw_result(answer.text);
  else
    console.raw_error(answer.text);
  return answer.code;
}

ExitCode start(const RunOptions& options, Console& console) {
  if (options.workers.value_or(1) > 1 && !is_launched())
    return launch(ranks_of(options, read_job(options.job, MissingFiles::accepted)), console);
  const MpiSession mpi;
  expect_no_exit(ExitCode::stopped, kept);
  handle_calls({warn_of_long_call, mpi.size() == 1 ? leave_stuck : nullptr});
  try {
    return execute(options, mpi, console);
  } catch (const CollectiveError& error) {
    leave_if_broken(mpi, error, console);
    console.error(error.what());
    if (const std::string cause = separate_processes_text(mpi.size()); !cause.empty()) console.warn(cause);
    return ExitCode::user_error;
  } catch (const std::exception& error) {
    fmt::print(stderr, "rodsweep: error: rank {} on {} failed: {}\n", mpi.rank(), host_name(), error.what());
    RunOptions again = options;
    again.resume = true;
    fmt::print(stderr, "rodsweep: the file keeps all finished work. Fix the cause, then continue with: {}\n",
               run_line(again, mpi.size()));
    std::fflush(nullptr);
    process_ends();
    MPI_Abort(mpi.world(), static_cast<int>(ExitCode::stopped));
    std::abort();
  }
}

ExitCode run_program(int argc, const char* const* argv, Console& console) {
  try {
    const Command command = parse_command_line(argc, argv);
    return std::visit([&](const auto& options) { return start(options, console); }, command);
  } catch (const std::exception& error) {
    console.error(error.what());
    return ExitCode::user_error;
  }
}

}  // namespace

}  // namespace rodsweep

int main(int argc, char** argv) {
  using namespace rodsweep;
  occupy_standard_descriptors();
  provide_home();
  std::signal(SIGPIPE, SIG_IGN);  // a closed reader must not end a sweep
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of file sizes (ulimit -f) is an error as of a full disk
  Console console(is_first_rank());
  ExitCode code = run_program(argc, argv, console);
  const int failure = console.close();
  if (failure != 0 && failure != EPIPE)
    console.error(fmt::format("writing to standard output failed: {}", std::strerror(failure)));
  if (failure == EPIPE && code == ExitCode::ok) {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  if (failure != 0 && code == ExitCode::ok) code = ExitCode::output_lost;
  if (hdf5_is_broken()) leave(code);
  process_ends();
  return static_cast<int>(code);
}
