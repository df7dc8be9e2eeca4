// The lifetime of PETSc: one object in main() around everything that solves.
//
// PETSC_COMM_WORLD is MPI_COMM_SELF, since a task belongs to one rank; PETSc's signal handler is off, since the runner
// has its own; no petscrc file is read, so that results do not depend on one. The environment's PETSC_OPTIONS does
// apply. If MPI is not running yet, the session starts and ends it. A session inside a session does nothing. Throws
// PetscError.
#pragma once

#include <string>

#include "solver/linear/petsc_error.hpp"

namespace rodsweep {

class PetscSession {
 public:
  PetscSession();
  ~PetscSession();
  PetscSession(const PetscSession&) = delete;
  PetscSession& operator=(const PetscSession&) = delete;

 private:
  bool owns_petsc_ = false, owns_mpi_ = false;
};

/// "3.18.5", of the library that runs.
std::string petsc_version();

}  // namespace rodsweep
