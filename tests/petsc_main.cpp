// Test programs that solve: MPI and PETSc start once, around all cases.
#include "solver/cg/petsc_session.hpp"
#include "tests/run_cases.hpp"

int main(int argc, char* argv[]) {
  const rodsweep::PetscSession petsc;
  return run_cases(argc, argv);
}
