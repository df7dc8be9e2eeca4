// The manual page, in the language of man(7): all that the program's --help and that of its commands say, on one page.
#pragma once

#include <string>

#include "runner/command/command_outline.hpp"

namespace rodsweep {

/// `title`: "rodsweep 1.0.0", for the page's foot.
std::string manual_page(const CommandOutline& program, const std::string& title);

}  // namespace rodsweep
