#include "runner/plan/task_list.hpp"

#include <stdexcept>

namespace rodsweep {

void TaskList::add(const Task& task) {
  Shape shape{task, {}};
  std::array<double, 5 + row_kinds> content{static_cast<double>(task.segments), static_cast<double>(task.joints),
                                            static_cast<double>(task.steps), static_cast<double>(task.frames),
                                            task.cost};
  for (std::size_t kind = 0; kind < row_kinds; ++kind) {
    shape.rows[kind] = task.rows[kind].count;
    content[5 + kind] = static_cast<double>(task.rows[kind].count);
  }
  const auto [known, is_new] = by_content_.try_emplace(content, static_cast<std::uint32_t>(shapes_.size()));
  if (is_new) shapes_.push_back(shape);
  entries_.push_back(
      {static_cast<std::int32_t>(task.point), static_cast<std::int32_t>(task.sample), task.own_guess, known->second});
  mark(size() - 1);
}

void TaskList::drop(Rows kind) {
  by_content_.clear();  // shapes may now be equal
  for (Shape& shape : shapes_) shape.rows[kind] = 0;
  marks_.clear();
  rows_.fill(0);
  for (std::int64_t index = 0; index < size(); ++index) mark(index);
}

Task TaskList::at(std::int64_t index) const { return task(index, first_rows(index)); }

PerRows<std::int64_t> TaskList::first_rows(std::int64_t index) const {
  if (index < 0 || index >= size()) throw std::out_of_range("TaskList: no such task");
  PerRows<std::int64_t> first = marks_[static_cast<std::size_t>(index / mark_every)];
  for (std::int64_t before = index / mark_every * mark_every; before < index; ++before) pass(before, first);
  return first;
}

double TaskList::cost(std::int64_t index) const { return shape(index).size.cost; }

const TaskList::Shape& TaskList::shape(std::int64_t index) const {
  return shapes_[entries_.at(static_cast<std::size_t>(index)).shape];
}

void TaskList::mark(std::int64_t index) {
  if (index % mark_every == 0) marks_.push_back(rows_);
  pass(index, rows_);
}

void TaskList::pass(std::int64_t index, PerRows<std::int64_t>& first) const {
  const PerRows<std::int64_t>& rows = shape(index).rows;
  for (std::size_t kind = 0; kind < row_kinds; ++kind) first[kind] += rows[kind];
}

Task TaskList::task(std::int64_t index, const PerRows<std::int64_t>& first) const {
  const Entry& entry = entries_[static_cast<std::size_t>(index)];
  const Shape& shape = shapes_[entry.shape];
  Task task{shape.size, index, entry.point, entry.sample, entry.own_guess, {}};
  for (std::size_t kind = 0; kind < row_kinds; ++kind) task.rows[kind] = {first[kind], shape.rows[kind]};
  return task;
}

}  // namespace rodsweep
