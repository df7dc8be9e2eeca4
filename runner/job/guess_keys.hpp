// Initial guesses in a job: names, keys, labels, and conversion to GuessSpec.
#pragma once

#include <string>
#include <vector>

#include "runner/job/job.hpp"
#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "runner/job/task.hpp"

namespace rodsweep {

/// One object key per kind of guess, with its parameters.
const std::vector<Key>& guess_keys();

/// `label`, allowed in any entry of the list of guesses, beside its parameters or its sweep.
const Key& guess_label_key();

/// Labels of the job's guesses, in order.
std::vector<std::string> guess_labels(const Job& job);

std::vector<GuessSpec> guess_specs(const Point& point, const Job& job);

}  // namespace rodsweep
