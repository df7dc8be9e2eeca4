// All cases inside one MPI session: for what opens results files. Under mpirun every rank runs the same cases, and
// the program fails if a rank does.
#include "runner/mpi/mpi_session.hpp"
#include "tests/run_cases.hpp"

int main(int argc, char** argv) {
  const rodsweep::MpiSession mpi;
  const int failures = run_cases(argc, argv);
  int worst = 1;
  MPI_Allreduce(&failures, &worst, 1, MPI_INT, MPI_MAX, mpi.world());
  return worst;
}
