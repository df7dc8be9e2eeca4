// Initial guesses in a job: their names, keys and labels, and what is made of them.
#pragma once

#include <string>
#include <vector>

#include "runner/job/job.hpp"
#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "runner/job/task.hpp"

namespace rodsweep {

/// By name, each an object of its parameters.
const std::vector<Key>& guess_keys();

/// `label`, which any entry of the list of guesses may have beside its parameters or its sweep.
const Key& guess_label_key();

/// Labels of the job's guesses, in order.
std::vector<std::string> guess_labels(const Job& job);

std::vector<GuessSpec> guess_specs(const Point& point, const Job& job);

}  // namespace rodsweep
