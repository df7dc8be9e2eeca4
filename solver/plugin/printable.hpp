// Text of others (plug-ins, Python, files, the system) in messages and in results files.
#pragma once

#include <string>
#include <string_view>

namespace rodsweep {

/// Control characters other than newline and tab become "\x1b" and so on, invalid UTF-8 becomes U+FFFD: a terminal would
/// obey the former, and other programs refuse the latter.
std::string printable(std::string_view text);

}  // namespace rodsweep
