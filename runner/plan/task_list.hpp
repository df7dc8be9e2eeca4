// The tasks of a plan in a few bytes each, so that every rank can store all tasks of a sweep of a million.
//
// Tasks with equal numbers of segments, steps and rows share a shape. A task is stored as shape, point and guess. Its
// first rows are sums over all earlier tasks, computed from the nearest earlier mark.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <vector>

#include "runner/plan/task.hpp"

namespace rodsweep {

class TaskList {
 public:
  /// Appends a task; its position determines its index and first rows. Points and samples are below 2^31.
  void add(const Task& task);

  /// Removes the rows of this kind from all tasks.
  void drop(Rows kind);

  std::int64_t size() const { return static_cast<std::int64_t>(entries_.size()); }
  const PerRows<std::int64_t>& rows() const { return rows_; }  ///< of all tasks together

  /// Both throw std::out_of_range.
  Task at(std::int64_t index) const;
  double cost(std::int64_t index) const;

  class Iterator;
  Iterator begin() const;
  Iterator from(std::int64_t index) const;
  Iterator end() const;

 private:
  struct Shape {
    TaskSize size;
    PerRows<std::int64_t> rows;
  };
  struct Entry {
    std::int32_t point, sample, own_guess;
    std::uint32_t shape;
  };
  static constexpr std::int64_t mark_every = 64;

  const Shape& shape(std::int64_t index) const;
  void mark(std::int64_t index);
  void pass(std::int64_t index, PerRows<std::int64_t>& first) const;  ///< advances `first` to the next task
  PerRows<std::int64_t> first_rows(std::int64_t index) const;
  Task task(std::int64_t index, const PerRows<std::int64_t>& first) const;

  std::vector<Entry> entries_;
  std::vector<Shape> shapes_;
  std::map<std::array<double, 5 + row_kinds>, std::uint32_t> by_content_;  ///< indices of shapes
  std::vector<PerRows<std::int64_t>> marks_;                               ///< first rows of each mark_every-th task
  PerRows<std::int64_t> rows_{};
};

/// Task by task, by value.
class TaskList::Iterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = Task;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = Task;

  Iterator(const TaskList& list, std::int64_t index, const PerRows<std::int64_t>& first = {})
      : list_(&list), index_(index), first_(first) {}

  Task operator*() const { return list_->task(index_, first_); }
  Iterator& operator++() {
    list_->pass(index_++, first_);
    return *this;
  }
  bool operator==(const Iterator& other) const { return index_ == other.index_; }
  bool operator!=(const Iterator& other) const { return index_ != other.index_; }

 private:
  const TaskList* list_;
  std::int64_t index_;
  PerRows<std::int64_t> first_;
};

inline TaskList::Iterator TaskList::begin() const { return {*this, 0}; }
inline TaskList::Iterator TaskList::from(std::int64_t index) const { return {*this, index, first_rows(index)}; }
inline TaskList::Iterator TaskList::end() const { return {*this, size()}; }

}  // namespace rodsweep
