// Provenance of a file: host, command, versions. Works without MPI_Init and PetscInitialize.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

namespace rodsweep {

struct Provenance {
  /// `host`: in a file the hosts of all ranks, set by ResultsFile.
  std::string begin_utc, host, user_command, revision, versions, petsc_options;
  std::string job;  ///< absolute path of the job file; its folder is the base of relative paths in the job
  int ranks = 1;
  int shard = 0, shards = 0;    ///< the shard that it ran; 0: the whole sweep
  bool oversubscribed = false;  ///< more ranks than cores: timings are invalid
};

/// One run of the program on a sweep or a training: a row of /runs. A training has neither left_s nor source.
struct RunRow {
  Provenance provenance;
  std::string end_utc;      ///< empty: still running, or killed
  int exit_code = -1;       ///< -1: still running, or killed
  double left_s = NAN;      ///< at the last heartbeat; NaN: unknown
  std::string source{};     ///< the extended or merged file that had this run; empty: a run of this file
  std::int64_t tasks = 0;   ///< tasks that this run completed (inspect())
  double task_seconds = 0;  ///< sum of their wall times (inspect())
};

/// Who ran a task (/timing/tasks).
struct TaskOrigin {
  std::int32_t rank = 0;
  std::int32_t run = 0;  ///< row of /runs
  std::string host;
  double write_s = 0;
};

/// Begins now, on this host, with this program. The caller sets the other members.
Provenance provenance_of_this_process(std::string user_command);

/// The git revision of the sources at configuration ("-dirty" with local changes), or "unknown".
std::string source_revision();

/// rodsweep, Open MPI (or another MPI), PETSc, HDF5, Eigen and the compiler, as "name version", and the processor, joined
/// by "; ".
std::string library_versions();

std::string host_name();

/// The current time, as 2025-11-21T16:05:09Z.
std::string utc_now();

/// Seconds since 1970 of such a text; 0 if invalid.
std::int64_t seconds_of_utc(const std::string& text);

}  // namespace rodsweep
