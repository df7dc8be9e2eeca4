// Catch2's main inside one MPI session: for what opens results files. Under mpirun every rank runs the same cases, and
// the program fails if a rank does.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "runner/mpi_session.hpp"

int main(int argc, char** argv) {
  const rodsweep::MpiSession mpi;
  const int failures = Catch::Session().run(argc, argv);
  int worst = 1;
  MPI_Allreduce(&failures, &worst, 1, MPI_INT, MPI_MAX, mpi.world());
  return worst;
}
