// What `rodsweep query` selects by: COLUMN OPERATOR VALUE, such as "scene.segments>=30", "outcome!=ok" or
// "scene.type=helix,bending_rod".
//
//   =  (or ==)   equal to one of the values, which commas (outside of parentheses) separate; of numbers, a value may be
//                a range LOW:HIGH, LOW: or :HIGH, ends included
//   !=           equal to none of them
//   < <= > >=    numbers
//   ~            texts that contain the value
// Numbers are equal up to a relative 1e-9, whatever the operator. A value that is not there (see
// runner/file/task_table.hpp) meets no condition. The scripts of analysis/ read the same language
// (rodsweep/reading/conditions.py); tests/conditions.json has cases that both must meet. Throws FileError: an unknown
// column or word, with the nearest known one; a number or an operator that does not fit the column.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "runner/file/task_table.hpp"

namespace rodsweep {

struct Condition {
  enum class Operator { equal, not_equal, less, at_most, more, at_least, contains };
  TaskColumn column;
  Operator comparison = Operator::equal;
  struct Range {
    double low, high;
  };
  std::vector<Range> ranges;       ///< of = and != on numbers
  double limit = 0;                ///< of < <= > >=
  std::vector<std::string> texts;  ///< of =, != and ~ on texts

  bool met(const ColumnValues& values, std::size_t task) const;
};

Condition parse_condition(const std::string& text, const TaskTable& table);

}  // namespace rodsweep
