// For tests without MPI and PETSc.
#include "tests/run_cases.hpp"

int main(int argc, char** argv) { return run_cases(argc, argv); }
