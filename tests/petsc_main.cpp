// For test programs that solve: one MPI and PETSc session around all cases.
#include "solver/cg/petsc_session.hpp"
#include "tests/run_cases.hpp"

int main(int argc, char* argv[]) {
  const rodsweep::PetscSession petsc;
  return run_cases(argc, argv);
}
