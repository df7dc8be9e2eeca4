// Random invalid jobs for tests of the reader, and checks of its error messages.
#pragma once

#include <random>
#include <string>
#include <string_view>

#include "tests/runner/job_examples.hpp"

namespace rodsweep {

/// The job after one to three changes: a key removed, misspelt or moved; a value of another kind, size or sign, or of
/// another key; misplaced sweeps and guesses. The same state of `random` gives the same job.
Json mutated(Json job, std::mt19937_64& random);

/// The error message for a job in `file`; "" if the job is valid. Also makes the plan, unless it is long.
std::string verdict(const std::string& text, const std::string& file);

/// What is wrong with an error message: a line does not begin with the file and a key, or it has an internal word.
/// "" if nothing is wrong.
std::string fault_of(const std::string& refusal, const std::string& file);

/// An internal word (such as "std::") that is in a message but not in the input; "" if there is none.
std::string inside_word(const std::string& message, std::string_view input = "");

}  // namespace rodsweep
