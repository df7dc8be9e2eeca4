#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "runner/file/file_reading.hpp"
#include "runner/terminal/process_copy.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::Contains;

TEST_CASE("what ends a copy of the process is known, and what it throws is not") {
  const pid_t original = getpid();
  CHECK(signal_of_copy([] {}) == 0);
  CHECK(signal_of_copy([] { throw std::runtime_error("in the copy"); }) == 0);
  CHECK(signal_of_copy([] { std::abort(); }) == SIGABRT);
  CHECK(signal_of_copy([] { std::raise(SIGKILL); }) == SIGKILL);
  CHECK(getpid() == original);
}

TEST_CASE("a file that ends its reader is refused as damaged, with what to do") {
  const std::string refusal = message_of<FileError>([] { rehearse("a.h5", [] { std::abort(); }); });
  CHECK_THAT(refusal, Contains("a.h5 is damaged or incomplete: reading it ended the reader by signal 6 (Aborted)") &&
                          Contains("Use a copy of it if there is one, or make it again"));
  rehearse("a.h5", [] { throw FileError("said by who reads it"); });
}

TEST_CASE("the words of a library are not those of a message") {
  CHECK(damage_text(std::out_of_range("vector::_M_range_check")) == "what it holds does not fit together");
  CHECK(damage_text(Hdf5Error("H5Dread failed")) == "H5Dread failed");
  CHECK(damage_text(Damage("/tasks/state is missing")) == "/tasks/state is missing");
}
