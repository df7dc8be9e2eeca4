// A JSON Schema of job files (draft-07, which editors support best), generated from the reader's table of keys
// (runner/keys/tables.hpp). It covers names, types, bounds, words, defaults, units, related keys, and sweeps. Only
// the reader checks conditions on several values: equal lengths of zips, "zero" among the guesses, unique labels,
// ascending ranges.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rodsweep {

nlohmann::ordered_json job_schema();

/// The output of `rodsweep schema` and the content of jobs/schema.json: a line per keyword, key of the job and definition.
/// `more`: keywords that validators ignore.
std::string job_schema_text(const nlohmann::ordered_json& more = nlohmann::ordered_json::object());

}  // namespace rodsweep
