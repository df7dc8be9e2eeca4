#include "runner/command/process_end.hpp"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "runner/mpi/mpi_session.hpp"

namespace rodsweep {
namespace {

std::atomic<bool> is_ending{false};

/// With Open MPI's orte_enable_recovery, ranks exit independently, and MPI_Abort ends only the calling rank.
bool ranks_exit_alone() {
  const char* told = std::getenv("OMPI_MCA_orte_enable_recovery");
  return told != nullptr && std::string_view(told) != "0";
}

}  // namespace

void process_ends() noexcept { is_ending = true; }

bool process_is_ending() noexcept { return is_ending; }

void leave(ExitCode code) {
  process_ends();
  std::_Exit(static_cast<int>(code));
}

void leave_lost_ranks(const MpiSession& mpi, ExitCode code) {
  if (mpi.rank() == 0) {
    process_ends();
    if (!ranks_exit_alone()) MPI_Abort(mpi.world(), static_cast<int>(code));
  } else if (!ranks_exit_alone()) {
    std::this_thread::sleep_for(std::chrono::minutes(1));  // until the MPI_Abort of rank 0
  }
  leave(code);
}

}  // namespace rodsweep
