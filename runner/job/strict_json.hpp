// JSON text to a value, refusing what a lenient parser lets through: a key given twice (nlohmann keeps the last one
// silently), numbers that overflow, nesting beyond reason. Keys keep the order in which they stand.
// Throws JobError (runner/job/job.hpp): for syntax with file, line, column and the line itself with a caret under the
// place, for the rest with file and key path.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace rodsweep {

nlohmann::ordered_json parse_strict_json(const std::string& text, const std::filesystem::path& file);

}  // namespace rodsweep
