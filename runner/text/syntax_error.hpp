// Explains a JSON syntax error and shows its line with a caret. nlohmann's parser reports the unexpected token, but the
// mistake is usually one token earlier: a missing or superfluous comma.
#pragma once

#include <cstddef>
#include <string>

namespace rodsweep {

/// "line 2, column 9: a comma is missing here", and that line with a caret. `last`: the position of the last character
/// of the unexpected token (the text's size at its end); `token`: the token as stored by the parser; `problem`: the
/// parser's message.
std::string syntax_error_text(const std::string& text, std::size_t last, const std::string& token,
                              const std::string& problem);

}  // namespace rodsweep
