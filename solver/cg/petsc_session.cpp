#include "solver/cg/petsc_session.hpp"

#include <petscsys.h>

#include <cctype>
#include <cstdlib>
#include <sstream>

namespace rodsweep {
namespace {

/// Keeps the message of the first error for its text, and prints nothing.
PetscErrorCode keep_message(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                            const char* message, void* kept) {
  if (type == PETSC_ERROR_INITIAL) *static_cast<std::string*>(kept) = message;
  return code;
}

}  // namespace

PetscSession::PetscSession() {
  PetscBool running = PETSC_FALSE;
  PetscInitialized(&running);
  if (running) return;

  int mpi_running = 0;
  MPI_Initialized(&mpi_running);
  if (!mpi_running) {  // PETSc refuses our communicator if it starts MPI itself
    if (MPI_Init(nullptr, nullptr) != MPI_SUCCESS) throw PetscError("MPI_Init failed");
    owns_mpi_ = true;
  }
  PETSC_COMM_WORLD = MPI_COMM_SELF;
  char program[] = "rodsweep", no_petscrc[] = "-skip_petscrc", no_handler[] = "-no_signal_handler";
  char* arguments[] = {program, no_petscrc, no_handler, nullptr};
  int count = 3;
  char** argv = arguments;
  std::string problem;
  PetscPushErrorHandler(keep_message, &problem);
  const bool failed = PetscInitialize(&count, &argv, nullptr, nullptr) != 0;
  PetscPopErrorHandler();
  if (failed) throw PetscError("PETSc did not start; correct PETSC_OPTIONS: " + problem);
  owns_petsc_ = true;
}

PetscSession::~PetscSession() {
  if (owns_petsc_) PetscFinalize();
  if (owns_mpi_) MPI_Finalize();
}

std::vector<std::string> idle_petsc_options() {
  std::vector<std::string> idle;
  const char* const given = std::getenv("PETSC_OPTIONS");
  std::istringstream words(given == nullptr ? "" : given);
  for (std::string word; words >> word;) {
    if (word.size() < 2 || word[0] != '-' || std::isalpha(static_cast<unsigned char>(word[1])) == 0) continue;
    PetscBool is_used = PETSC_FALSE;
    if (PetscOptionsUsed(nullptr, word.c_str() + 1, &is_used) == 0 && !is_used) idle.push_back(word);
  }
  return idle;
}

}  // namespace rodsweep
