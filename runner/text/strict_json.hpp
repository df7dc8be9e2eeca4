// Strict JSON parser: duplicate keys (nlohmann silently keeps the last one), overflowing numbers and deep nesting are
// errors. Keys keep their order.
// Throws JobError. Syntax errors contain file, line, column and the line with a caret; other
// errors contain file and key path.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace rodsweep {

nlohmann::ordered_json parse_strict_json(const std::string& text, const std::filesystem::path& file);

}  // namespace rodsweep
