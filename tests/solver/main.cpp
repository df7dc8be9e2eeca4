// The solver's test programs: MPI and PETSc start once, around all cases.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "solver/petsc_session.hpp"

int main(int argc, char* argv[]) {
  const rodsweep::PetscSession petsc;
  return Catch::Session().run(argc, argv);
}
