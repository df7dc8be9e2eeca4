// The checksum of one task (/tasks/checksum): its index, outcome and message as stored, then all columns outside
// /timing in the order of columns(). Empty optional columns are skipped, because older files do not have them.
// Used for writing and verifying.
#pragma once

#include <cstdint>

#include "runner/file/record.hpp"

namespace rodsweep {

std::uint64_t task_checksum(std::int64_t task, const TaskRecord& record);

}  // namespace rodsweep
