// A JSON Schema (draft-07, the one that editors support best) of job files, made from the table of keys that the reader
// uses (runner/job/job_keys.hpp): names, types, bounds, words, defaults, units, which keys belong together, and sweeps
// wherever the reader takes one. What depends on several values at once (zips of one length, "zero" among the guesses,
// labels that differ, ranges in ascending order) only the reader knows.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rodsweep {

nlohmann::ordered_json job_schema();

/// As `rodsweep schema` prints it and jobs/schema.json holds it: a line per key of the job and per definition.
std::string job_schema_text();

}  // namespace rodsweep
