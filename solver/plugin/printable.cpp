#include "solver/plugin/printable.hpp"

#include <boost/nowide/utf/convert.hpp>

namespace rodsweep {

std::string printable(std::string_view text) {
  constexpr char digits[] = "0123456789abcdef";
  const std::string valid = boost::nowide::utf::convert_string<char>(text.data(), text.data() + text.size());
  std::string shown;
  for (std::size_t i = 0; i < valid.size(); ++i) {
    auto code = static_cast<unsigned char>(valid[i]);
    // U+0080 to U+009F are control characters too: 0xC2 and their number.
    const auto next = i + 1 < valid.size() ? static_cast<unsigned char>(valid[i + 1]) : 0U;
    const bool is_c1 = code == 0xC2 && next < 0xA0;
    if (is_c1) code = static_cast<unsigned char>(next), ++i;
    if (is_c1 || code == 0x7F || (code < 0x20 && code != '\n' && code != '\t'))
      shown += {'\\', 'x', digits[code >> 4], digits[code & 15]};
    else
      shown += static_cast<char>(code);
  }
  return shown;
}

}  // namespace rodsweep
