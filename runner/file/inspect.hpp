// A summary of a results file for `rodsweep status` and `rodsweep info`: read-only, without MPI or a plan. Works while
// a sweep writes the file, because it takes no lock and a task's state byte is set after its data.
// Throws FileError if the file is missing, foreign, damaged or of another schema version.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/provenance.hpp"

namespace rodsweep {

struct FailedTask {
  std::int64_t index = 0;
  std::string outcome;  ///< to_string(TaskOutcome)
  std::string message;
};

/// A started but unfinished task: it is running, or its worker died.
struct BegunTask {
  std::int64_t index = 0;
  int run = 0;  ///< row of /runs
  int rank = 0;
  std::string host;
};

struct FileSummary {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
  int schema_version = 0;
  std::string job_name, job_kind, job_text, plan_hash;
  std::optional<std::int64_t> rerun_of_task;  ///< the file holds only a rerun of this task
  std::vector<std::string> guesses;           ///< labels of /axes/guess; empty without cg
  std::vector<double> tolerances;             ///< /axes/tolerance

  std::int64_t tasks = 0;    ///< size of the plan
  std::int64_t done = 0;     ///< ok + failed
  std::int64_t failed = 0;   ///< done with an outcome other than "ok"
  std::int64_t pending = 0;  ///< tasks - done
  std::map<std::string, std::int64_t> done_by_outcome;
  std::vector<FailedTask> failures;         ///< by index
  std::vector<BegunTask> begun;             ///< by index
  std::optional<bool> being_written;        ///< by a live run; empty: unknown, without file locks
  double silent_s = 0;                      ///< since the last heartbeat
  std::optional<double> momentum_residual;  ///< maximum over finished tasks that measured it
  std::vector<RunRow> runs;
};

/// Liveness timeout: a run renews its file's modification time every second.
inline constexpr double alive_s = 30;

/// Time since the file's modification by this host's clock; at least 0, because the file server's clock may differ.
double silent_seconds(const std::filesystem::path& path);

FileSummary inspect(const std::filesystem::path& path);

/// Solves to the job's tolerance in tasks that are ok, over all guesses.
struct SolveCounts {
  std::int64_t timed = 0, missed = 0;
};

/// Zeros for a file that is older than these columns.
SolveCounts count_solves(const std::filesystem::path& path);

struct Verification {
  std::int64_t checked = 0;           ///< finished tasks
  std::vector<std::int64_t> damaged;  ///< tasks with a wrong checksum
};

/// Reads all data of finished tasks (outside /timing) and compares it with /tasks/checksum.
Verification verify(const std::filesystem::path& path);

}  // namespace rodsweep
