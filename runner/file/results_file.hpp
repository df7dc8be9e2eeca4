// The one HDF5 file of a sweep, written by many ranks at once (MPI-IO, independent transfers).
//
// Created whole before the sweep, by rank 0 (runner/file/file_creation.hpp): every dataset is contiguous with early
// allocation, so that no rank creates an object at run time; unwritten bytes are zero and `/tasks/state` is zero,
// "pending". A worker writes all rows of a task, sentinels included, brings them to disk, and writes the state byte
// after that: a task whose state is 1 is complete, whatever happened to any process, or to the machine's power, since.
// Several tasks share a sync, which takes no more than a fiftieth of the time. Metadata never change while the sweep
// runs, so a killed sweep leaves a sound file. The layout is that of columns() (runner/file/columns.hpp) plus /job,
// /runs, /axes and the plan's columns in /tasks: see runner/file/layout.hpp.
//
// Errors: FileError (the user's: exists already, not ours, another job, no space), Hdf5Error (a failing call, with its
// name).
#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/file_creation.hpp"
#include "runner/file/file_error.hpp"
#include "runner/file/file_lock.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/record.hpp"
#include "runner/file/task_times.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Of a sweep that goes on: which tasks that ended are run again.
enum class Retry { none, failed };

class ResultsFile {
 public:
  /// Collective over `comm`. Refuses a path that exists and a disk that is too full (before creating anything). All
  /// ranks throw the same error. `earlier`: files that this one takes tasks from; their rows of /runs come first here.
  static ResultsFile create(const std::filesystem::path& path, const Plan& plan, const Provenance& provenance,
                            MPI_Comm comm, const FreeSpace& free_space = free_bytes,
                            const std::vector<std::filesystem::path>& earlier = {});
  /// Collective. Refuses a file of another program, schema version, plan or job text, and one that another run is
  /// writing. Tasks whose data are not what was written (checksums; the ranks share the work, and show meanwhile that
  /// they live) count as pending again, and on request those that failed and may end otherwise (may_change()). Appends
  /// a row to /runs. Nothing, the same on every rank, where any rank is told to `stop` before all are verified: the
  /// file stays as it is.
  static std::optional<ResultsFile> resume(
      const std::filesystem::path& path, const Plan& plan, const Provenance& provenance, MPI_Comm comm,
      Retry retry = Retry::none, const std::function<bool()>& stop = [] { return false; });

  ResultsFile(ResultsFile&&) noexcept;
  ResultsFile& operator=(ResultsFile&&) noexcept;
  /// Commits, and closes, which is collective, unless an exception unwinds this rank: the others need not be on their
  /// way here, and nothing is lost, since writes are not buffered.
  ~ResultsFile();

  /// Which tasks are complete, by task index (from the state bytes as they were when the file was opened).
  const std::vector<std::uint8_t>& done() const { return done_; }
  /// Of every task, its tries in earlier runs whose workers crashed.
  const std::vector<std::uint8_t>& tries() const { return tries_; }
  int run_index() const { return run_index_; }  ///< this run's row of /runs
  /// What the user should hear about this file though it is no error; empty: nothing.
  const std::string& note() const { return note_; }

  /// Independent, before a rank runs a task: counts the try, and stores which rank runs it.
  void begin(const Task& task);
  /// Independent: uncounts a try that was abandoned on request, and stores how far it came if it is the longest so far.
  /// Another rank may have the task by now, or have finished it: its results stay untouched.
  void abandon(const Task& task, const Try& tried = {});

  /// Independent: any rank, any task that is not done() yet, once. It is complete with the next commit(), which this is
  /// too where one is due. `origin`: who ran it, where that was not this run.
  void write(const Task& task, const TaskRecord& record, const TaskOrigin* origin = nullptr);

  /// Independent: brings this rank's tasks to disk, then says that they are complete.
  void commit();
  void commit_if_due();
  std::int64_t committed() const;  ///< tasks of this rank in this run

  /// Independent, one rank: shows in the file's modification time, every few seconds, that this run lives.
  void beat();

  /// Independent, one rank: how this run ended (row of /runs).
  void end_run(const std::string& end_utc, int exit_code);

  /// Collective: commits, closes the file, brings it to disk and reports failure, which the destructor cannot.
  void close();

  /// Independent, in its place where ranks are lost: commits, brings all to disk, and closes nothing.
  void leave();

 private:
  struct Open;
  ResultsFile(const std::filesystem::path& path, const Plan& plan, std::vector<std::uint8_t> done, int runs,
              std::vector<std::uint8_t> tries, const Provenance& provenance, MPI_Comm comm, FileLock lock);

  void add_note(const std::string& text);
  void take_back(const std::vector<std::uint8_t>& again, MPI_Comm comm);

  std::unique_ptr<Open> open_;
  std::vector<std::uint8_t> done_, tries_;
  std::map<std::int64_t, std::uint8_t> before_;  ///< tasks that this rank runs: their tries before
  int run_index_ = 0;
  std::string note_;
};

}  // namespace rodsweep
