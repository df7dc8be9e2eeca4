// For tests of results files: one MPI and PETSc session around all cases. Under mpirun all ranks run the same cases; the
// program fails if any rank fails.
#include "runner/mpi/mpi_session.hpp"
#include "solver/cg/petsc_session.hpp"
#include "tests/run_cases.hpp"

int main(int argc, char** argv) {
  const rodsweep::MpiSession mpi;
  const rodsweep::PetscSession petsc;
  const int failures = run_cases(argc, argv);
  int worst = 1;
  MPI_Allreduce(&failures, &worst, 1, MPI_INT, MPI_MAX, mpi.world());
  return worst;
}
