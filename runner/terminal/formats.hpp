// Formats durations, sizes and command lines for users.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace rodsweep {

std::string duration_text(double seconds);   ///< "850 ms", "12.3 s", "4 min 05 s", "2 h 03 min", "3 d 04 h", "7 years"
std::string bytes_text(std::int64_t bytes);  ///< "512 B", "4.2 MB", in powers of 1000
std::string count_text(std::int64_t count, std::string_view noun);           ///< "1 task", "12 tasks"
std::string shell_quoted(std::string_view word);                             ///< quoted for a POSIX shell if necessary
std::string json_text(const nlohmann::ordered_json& value, int indent = 2);  ///< invalid UTF-8: U+FFFD

}  // namespace rodsweep
