// Compiles Catch2 once for all test programs, since that takes longer than any of our tests. Each program has its own
// main().
#pragma once

/// Runs the cases that the command line selects; returns the exit code.
int run_cases(int argc, char** argv);
