// The checksum of one task (/tasks/checksum): its index, outcome and message as the file holds them, then every column
// outside /timing in the order of columns(), but for those of contact where there are none: files that are older than
// these know nothing of them. Writing and verifying ask for the same sum.
#pragma once

#include <cstdint>

#include "runner/file/record.hpp"

namespace rodsweep {

std::uint64_t task_checksum(std::int64_t task, const TaskRecord& record);

}  // namespace rodsweep
