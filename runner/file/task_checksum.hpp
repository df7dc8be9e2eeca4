// The checksum of one task (/tasks/checksum): its index, outcome and message as the file holds them, then every column
// outside /timing in the order of visit_columns(). Writing and verifying build it with the same calls.
#pragma once

#include <string>
#include <string_view>

#include "runner/file/hdf5.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/record.hpp"
#include "runner/job/checksum.hpp"

namespace rodsweep {

class TaskChecksum {
 public:
  TaskChecksum(std::int64_t task, std::string_view outcome, std::string_view message)
      : outcome_(hdf5::fixed_text(outcome, outcome_bytes)), message_(hdf5::fixed_text(message, message_bytes)) {
    sum_.add(&task, sizeof task);
    sum_.add(outcome_.data(), outcome_.size());
    sum_.add(message_.data(), message_.size());
  }

  static bool covers(const Column& column) { return std::string_view(column.path).substr(0, 8) != "/timing/"; }

  /// The task's rows of a column; those that it does not cover are passed over, and those of contact where there are
  /// none, which files that are older than these columns know nothing of.
  void add(const Column& column, const void* values, std::size_t bytes) {
    const bool of_contact = column.rows == Rows::contact_task || column.rows == Rows::contact_step;
    if (covers(column) && (bytes > 0 || !of_contact)) sum_.add(values, bytes);
  }

  std::uint64_t value() const { return sum_.value(); }
  const std::string& outcome() const { return outcome_; }  ///< padded
  const std::string& message() const { return message_; }  ///< padded

 private:
  Checksum sum_;
  std::string outcome_, message_;
};

}  // namespace rodsweep
