// The lifetime of PETSc: one object in main() around everything that solves.
//
// PETSC_COMM_WORLD is MPI_COMM_SELF, since a task runs on one rank. PETSc's signal handler is off, since the runner has
// its own. No petscrc file is read, so that results do not depend on one; the environment variable PETSC_OPTIONS does
// apply. If MPI is not initialised, the session initialises and finalises it. A nested session does nothing. Throws
// PetscError.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace rodsweep {

/// A PETSc call failed: a bug or lack of memory, not an error of the user. The text names the call.
class PetscError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class PetscSession {
 public:
  PetscSession();
  ~PetscSession();
  PetscSession(const PetscSession&) = delete;
  PetscSession& operator=(const PetscSession&) = delete;

 private:
  bool owns_petsc_ = false, owns_mpi_ = false;
};

/// Options of PETSC_OPTIONS that nothing has read since the start of PETSc, such as "-pc_type". Solvers read none, so
/// these have no effect.
std::vector<std::string> idle_petsc_options();

}  // namespace rodsweep
