// The keys of `time`, `solve` and initial guesses in a job, and the specs constructed from them at a parameter point.
// Single values are already validated; conditions on several values are checked here. Throws JobError.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runner/inputs/input_file.hpp"
#include "runner/keys/key.hpp"
#include "runner/keys/point.hpp"
#include "runner/specs/guess_spec.hpp"
#include "runner/specs/task_spec.hpp"

namespace rodsweep {

Key start_key();
Key time_key();
Key solve_key();

std::optional<StartSpec> start_spec(const Point& point, const JobFiles& job);
TimeSpec time_spec(const Point& point, const JobFiles& job);
SolveSpec solve_spec(const Point& point, const JobFiles& job);  ///< default: the direct solve (data sets)
Evaluation evaluation(const Point& point);                      ///< default: paired
OutputSpec output_spec(const nlohmann::ordered_json& record);

/// Throws JobError if the solve method conflicts with other settings, such as a paired evaluation.
/// `labels`: of the job's guesses.
void check_method(const Point& point, const std::vector<std::string>& labels, const JobFiles& job);

/// Throws JobError if the solve method does not have what is recorded.
void check_output(const OutputSpec& output, const Point& point, const JobFiles& job);

/// Labels of the guesses of a validated job, in order.
std::vector<std::string> guess_labels(const nlohmann::ordered_json& guesses);

std::vector<GuessSpec> guess_specs(const Point& point, const std::vector<std::string>& labels, const JobFiles& job);

}  // namespace rodsweep
