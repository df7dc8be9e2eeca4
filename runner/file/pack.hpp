// Makes a compressed copy of a results file for archives: the same objects, attributes, types and values. All but small
// datasets are stored in shuffled, deflated chunks with checksums. All readers accept the copy. A sweep cannot be
// resumed in it, because ranks cannot write compressed chunks independently.
//
// The checksums of finished tasks are verified before and after. If a sweep writes the source, tasks that finish during
// the copy stay pending in it. The copy gets its name when it is complete. One process, no MPI. Throws FileError:
// damaged or foreign source, existing target, full disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "runner/file/hdf5.hpp"

namespace rodsweep {

struct Packing {
  std::int64_t tasks = 0, verified = 0;  ///< in the plan; verified in the copy
  std::uintmax_t bytes_before = 0, bytes_after = 0;
};

/// Called often; throws to end the copy, which leaves no file.
using Continue = std::function<void()>;

Packing pack_results(
    const std::filesystem::path& source, const std::filesystem::path& target, const Continue& go_on = [] {});

/// Whether pack_results() made this file.
bool is_packed(const hdf5::File& file);

}  // namespace rodsweep
