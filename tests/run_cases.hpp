// Catch2 compiled once for all test programs (it takes longer than any test of ours); each has a main() of its own
// around it.
#pragma once

/// Runs the cases that the command line chooses; returns the exit code.
int run_cases(int argc, char** argv);
