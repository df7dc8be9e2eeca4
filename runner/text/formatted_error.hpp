// The base of error classes whose text is composed of a format and its values: FileError("{} is not a file", path).
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace rodsweep {

template <class Base = std::runtime_error>
class FormattedError : public Base {
 public:
  using Base::Base;  ///< a text alone is not a format
  template <class First, class... More>
  explicit FormattedError(fmt::format_string<First, More...> text, First&& first, More&&... more)
      : Base(fmt::format(text, std::forward<First>(first), std::forward<More>(more)...)) {}
};

}  // namespace rodsweep
