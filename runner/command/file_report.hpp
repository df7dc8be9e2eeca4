// What `status` and `info` say of a results file, in words and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "runner/file/inspect.hpp"

namespace rodsweep {

std::string outcomes_text(const FileSummary& file);  ///< "98 ok, 2 torn"

/// Start `index` of the sweep, a line.
std::string start_text(const FileSummary& file, std::size_t index);

nlohmann::ordered_json to_json(const FileSummary& file);

}  // namespace rodsweep
