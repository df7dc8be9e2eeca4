// A compressed copy of a results file for keeping and sending: the same objects, attributes, types and values, but
// every dataset of some size in chunks that are shuffled, deflated and carry a checksum. All readers take it for the
// file it was made from; it cannot be continued, since ranks cannot write compressed chunks independently.
//
// The finished tasks are compared with their checksums (/tasks/checksum) before and after. A file in which a sweep
// still writes is packed as it was at the start: tasks that finish meanwhile stay pending in the copy. The copy gets
// its name when it is whole. One process, no MPI. Throws FileError: damaged or foreign source, existing target, full
// disk.
#pragma once

#include <cstdint>
#include <filesystem>

#include "runner/file/hdf5.hpp"

namespace rodsweep {

struct Packing {
  std::int64_t tasks = 0, verified = 0;  ///< of the plan; finished ones whose checksums held in the copy
  std::uintmax_t bytes_before = 0, bytes_after = 0;
};

Packing pack_results(const std::filesystem::path& source, const std::filesystem::path& target);

/// Was this results file made by pack_results()?
bool is_packed(const hdf5::File& file);

}  // namespace rodsweep
