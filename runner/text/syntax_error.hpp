// What is wrong with a text that is no JSON, and where: the line, with a caret under the place. nlohmann's parser names
// the token that it could not take; what its author did is mostly one token earlier, a comma that is missing or too
// many.
#pragma once

#include <cstddef>
#include <string>

namespace rodsweep {

/// "line 2, column 9: a comma is missing here", and that line with a caret. `last` is the place of the last character
/// of the token that the parser refused (the text's size at its end), `token` as far as it remembers it, `problem` its
/// words.
std::string syntax_error_text(const std::string& text, std::size_t last, const std::string& token,
                              const std::string& problem);

}  // namespace rodsweep
