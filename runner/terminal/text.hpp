// Formats durations, sizes and command lines for users.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace rodsweep {

std::string duration_text(double seconds);  ///< "850 ms", "12.3 s", "4 min 05 s", "2 h 03 min", "3 d 04 h", "7 years"
std::string short_duration_text(double seconds);  ///< three digits: "12.3 us", "4.56 ms", "789 s"; NaN: "-"
std::string bytes_text(std::int64_t bytes);       ///< "512 B", "4.2 MB", in powers of 1000
std::string counted(std::int64_t count, std::string_view noun);  ///< "1 task", "12 tasks"
std::string shell_quoted(std::string_view word);                 ///< quoted for a POSIX shell if necessary
std::string csv_text(std::string_view text);                     ///< quoted as a CSV cell if necessary (RFC 4180)
std::size_t characters(std::string_view text);                   ///< number of UTF-8 characters
std::string json_text(const nlohmann::ordered_json& value, int indent = 2);  ///< invalid UTF-8: U+FFFD

}  // namespace rodsweep
