// Who made a file and with what. Works without MPI_Init and PetscInitialize.
#pragma once

#include <cstdint>
#include <string>

namespace rodsweep {

struct Provenance {
  /// `host`: in a file the hosts of all ranks, which ResultsFile finds out.
  std::string begin_utc, host, user_command, revision, versions, petsc_options;
  std::string job;  ///< absolute path of the job file: relative paths in the job begin in its folder
  int ranks = 1;
  int shard = 0, shards = 0;    ///< the part of the sweep that it ran; 0: the whole
  bool oversubscribed = false;  ///< more ranks than cores: timings mean nothing
};

/// One run of the program on a sweep: a row of /runs.
struct RunRow {
  Provenance provenance;
  std::string end_utc;      ///< empty: still running, or killed
  int exit_code = -1;       ///< -1: still running, or killed
  std::string source;       ///< the file that this one extends, whose run it was; empty: a run of this sweep
  std::int64_t tasks = 0;   ///< tasks that this run completed (inspect())
  double task_seconds = 0;  ///< their wall time, summed (inspect())
};

/// Who ran a task (/timing/tasks).
struct TaskOrigin {
  std::int32_t rank = 0;
  std::int32_t run = 0;  ///< row of /runs
  std::string host;
  double write_s = 0;
};

/// Begins now, on this host, with this program; `ranks` and `oversubscribed` are for the caller to complete.
Provenance provenance_of_this_process(std::string user_command);

/// The git revision of the sources when they were configured ("-dirty" with local changes), or "unknown".
std::string source_revision();

/// rodsweep, Open MPI (or another MPI), PETSc, HDF5, Eigen and the compiler, as "name version" joined by "; ".
std::string library_versions();

std::string host_name();

/// Now, as 2025-11-21T16:05:09Z.
std::string utc_now();

/// Seconds since 1970 of such a text; 0 of another.
std::int64_t seconds_of_utc(const std::string& text);

}  // namespace rodsweep
