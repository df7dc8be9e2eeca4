// What ranks do together before they open one file for writing.
//
// MPI-IO opens a file on all ranks at once: if one of them does not find it, the others wait for it forever. Before a run
// continues a file, it checks that this is one of its plan and that no other run writes it, and verifies the finished tasks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/file_lock.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Collective; makes the folder of `path`. All ranks throw the same FileError unless every rank finds there what rank 0
/// writes, and the path is short enough for MPI-IO.
void check_common_place(const std::filesystem::path& path, MPI_Comm comm);

/// Collective: runs `work` on rank 0. If it throws, every rank throws a FileError with the same text.
void on_first_rank(MPI_Comm comm, const std::function<void()>& work);

/// Which ended tasks a resumed sweep runs again.
enum class Retry { none, failed };

/// Whether to go on verifying the tasks of a resumed file, to trust the others, or to leave the file.
enum class Verify { on, enough, stop };

struct ResumedFile {
  FileLock lock;                         ///< on rank 0
  std::vector<std::uint8_t> done;        ///< by task, 0 or 1; without the tasks to run again
  std::vector<std::uint8_t> tries;       ///< by task
  std::vector<std::int64_t> again;       ///< tasks that are complete in the file, to be marked as pending
  int runs = 0;                          ///< number of used rows of /runs
  bool is_verified = true, is_complete;  ///< whether all finished tasks were verified; whether all tasks are done
  std::string note;                      ///< a warning for the user; may be empty
};

/// Collective: ResultsFile::resume() until the file is opened for writing. Mends invalid state bytes.
std::optional<ResumedFile> resume_file(const std::filesystem::path& path, const Plan& plan, MPI_Comm comm, Retry retry,
                                       const std::function<Verify()>& verifying);

}  // namespace rodsweep
