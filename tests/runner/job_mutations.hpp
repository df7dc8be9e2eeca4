// Jobs with something wrong in them, for tests of what reads jobs, and what a refusal must not look like.
#pragma once

#include <random>
#include <string>
#include <string_view>

#include "tests/runner/job_examples.hpp"

namespace rodsweep {

/// The job after a few changes: a key taken away, misspelt, or put elsewhere; a value of another kind, size or sign, or
/// that of another key; sweeps and guesses in the wrong places. The same job for the same state of `random`.
Json mutated(Json job, std::mt19937_64& random);

/// What a user is told of a job in `file`, "" if it is sound; its plan is looked at too unless it is long.
std::string verdict(const std::string& text, const std::string& file);

/// What is wrong with a refusal: a line that does not begin with the file and a key, or a word of the program's
/// insides.
/// "" where it is plain.
std::string fault_of(const std::string& refusal, const std::string& file);

/// A word of the program's insides in a message that is not in the input; "" if there is none.
std::string inside_word(const std::string& message, std::string_view input = "");

}  // namespace rodsweep
