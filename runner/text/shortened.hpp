// Shortens a user's text for messages; cuts between characters.
#pragma once

#include <string>

namespace rodsweep {

inline std::string shortened(const std::string& text, std::size_t longest = 60) {
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // inside a UTF-8 character
  return text.substr(0, end) + "...";
}

}  // namespace rodsweep
