// JSON text to a value, refusing what a lenient parser lets through: a key given twice (nlohmann keeps the last one
// silently), numbers that overflow, nesting beyond reason. Keys keep the order in which they stand.
// Throws JobError (runner/job/job.hpp) with file, line and column for syntax, file and key path for the rest.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace rodsweep {

nlohmann::ordered_json parse_strict_json(const std::string& text, const std::filesystem::path& file);

}  // namespace rodsweep
