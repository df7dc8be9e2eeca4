#define CATCH_CONFIG_RUNNER  // version 2
#include "tests/run_cases.hpp"

#include "tests/catch.hpp"

int run_cases(int argc, char** argv) { return Catch::Session().run(argc, argv); }
