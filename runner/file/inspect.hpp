// A results file as seen from outside, for `rodsweep status` and `rodsweep info`: read-only, without MPI, without a
// plan. Works while a sweep writes to the file (no lock is taken; the state byte of a task is set after its data).
// Throws FileError for what is missing, foreign, damaged or of another schema version.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/file/provenance.hpp"

namespace rodsweep {

struct FailedTask {
  std::int64_t index = 0;
  std::string outcome;  ///< to_string(TaskOutcome)
  std::string message;
};

/// A task that a worker began and did not finish: it runs, or its worker ended while it ran.
struct BegunTask {
  std::int64_t index = 0;
  int start = 0;  ///< row of /runs
  int rank = 0;
  std::string host;
};

struct FileSummary {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
  int schema_version = 0;
  std::string job_name, job_kind, job_text, plan_hash;
  std::optional<std::int64_t> rerun_of_task;  ///< the file holds that task of the job alone, run again
  std::vector<std::string> guesses;           ///< labels of /axes/guess; empty without cg
  std::vector<double> tolerances;             ///< /axes/tolerance

  std::int64_t tasks = 0;    ///< size of the plan
  std::int64_t done = 0;     ///< ok + failed
  std::int64_t failed = 0;   ///< done with an outcome other than "ok"
  std::int64_t pending = 0;  ///< tasks - done
  std::map<std::string, std::int64_t> done_by_outcome;
  std::vector<FailedTask> failures;         ///< in order of their index
  std::vector<BegunTask> begun;             ///< likewise
  std::optional<bool> being_written;        ///< by a run that lives; empty: the file system does not tell
  double silent_s = 0;                      ///< since the file's time changed, which a run renews every 5 s
  std::optional<double> momentum_residual;  ///< the largest of finished tasks that measured it
  std::vector<RunRow> runs;
};

/// A run renews its file's time every 5 s: one that is silent for longer does not live.
inline constexpr double alive_s = 30;

/// Since the file's time changed, by this host's clock, which need not be that of whoever keeps the file: at least 0.
double silent_seconds(const std::filesystem::path& path);

FileSummary inspect(const std::filesystem::path& path);

struct Verification {
  std::int64_t checked = 0;           ///< finished tasks
  std::vector<std::int64_t> damaged;  ///< those whose data do not have the checksum they were written with
};

/// Reads everything that finished tasks wrote (outside /timing) and compares it with /tasks/checksum.
Verification verify(const std::filesystem::path& path);

}  // namespace rodsweep
