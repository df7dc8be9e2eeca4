// The rows of a column, each of `width` values, appended one by one. While all rows are equal, one is stored: of the
// parameters of a million tasks, most are constant.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

namespace rodsweep {

template <class Value>
class ColumnValues {
 public:
  explicit ColumnValues(std::size_t width = 1) : width_(width) {}

  void append(const Value* row) {
    if (rows_++ == 0) {
      values_.assign(row, row + width_);
    } else if (values_.size() > width_ || !equal(row, values_.data())) {
      if (values_.size() == width_) values_ = repeated(rows_ - 1);
      values_.insert(values_.end(), row, row + width_);
    }
  }

  /// All rows, one after another.
  std::vector<Value> all() const { return values_.size() == width_ ? repeated(rows_) : values_; }
  /// One row if all rows are equal, else all.
  const std::vector<Value>& distinct() const { return values_; }

 private:
  bool equal(const Value* a, const Value* b) const {
    if constexpr (std::is_arithmetic_v<Value>)
      return std::memcmp(a, b, width_ * sizeof(Value)) == 0;  // NaN equals NaN
    else
      return std::equal(a, a + width_, b);
  }
  std::vector<Value> repeated(std::size_t times) const {
    std::vector<Value> rows;
    rows.reserve(times * width_);
    for (std::size_t i = 0; i < times; ++i) rows.insert(rows.end(), values_.begin(), values_.end());
    return rows;
  }

  std::size_t width_, rows_ = 0;
  std::vector<Value> values_;
};

}  // namespace rodsweep
