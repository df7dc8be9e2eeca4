// For tests of results files: one MPI session around all cases. Under mpirun all ranks run the same cases; the program
// fails if any rank fails.
#include "runner/mpi/mpi_session.hpp"
#include "tests/run_cases.hpp"

int main(int argc, char** argv) {
  const rodsweep::MpiSession mpi;
  const int failures = run_cases(argc, argv);
  int worst = 1;
  MPI_Allreduce(&failures, &worst, 1, MPI_INT, MPI_MAX, mpi.world());
  return worst;
}
