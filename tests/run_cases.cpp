#define CATCH_CONFIG_RUNNER
#include "tests/run_cases.hpp"

#include <catch2/catch.hpp>

int run_cases(int argc, char** argv) { return Catch::Session().run(argc, argv); }
