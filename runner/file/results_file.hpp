// The HDF5 file of a sweep, written by many ranks at once (MPI-IO, independent transfers).
//
// Rank 0 creates the complete file before the sweep (create_results_file()). All datasets are contiguous with
// early allocation, so no rank creates objects at run time; unwritten bytes and `/tasks/state` are zero ("pending").
// A worker writes all rows of a task including sentinels, syncs them, then writes the state byte. So a task with state
// 1 is complete, even after crashes or a power cut. Several tasks share a sync; syncs take at most 2 % of the time.
// Metadata never changes during the sweep, so a killed sweep leaves a valid file. The layout is columns()
// (runner/file/columns.hpp) plus /job, /runs, /axes and the plan's columns in /tasks: see runner/file/layout.hpp.
//
// Errors: FileError (user error: exists already, foreign file, another job, no space), Hdf5Error (a failed call).
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

#include "runner/file/durable.hpp"
#include "runner/file/opening.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/record.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Bytes that this process may still write to a folder.
using FreeSpace = std::function<std::uintmax_t(const std::filesystem::path& folder)>;
std::uintmax_t free_bytes(const std::filesystem::path& folder);

/// Creates the file, complete except for the results, on one process with HDF5's default driver, in file_creation.cpp.
/// It has a temporary name until it is complete (runner/file/unfinished_file.hpp). Its blocks are reserved if the file
/// system supports this, so that the disk can't become full during the sweep. Throws FileError (exists, no space, no
/// permission) and Hdf5Error. `earlier`: files whose tasks are copied. Their /runs come first, as far as they fit with
/// one row left for this run. Returns the number of used rows of /runs.
int create_results_file(const std::filesystem::path& path, const Plan& plan, const FreeSpace& free_space,
                        const std::vector<std::filesystem::path>& earlier = {});

/// Size of the file of this plan.
std::int64_t file_bytes(const Plan& plan);

class ResultsFile {
 public:
  /// Collective over `comm`. All ranks throw the same FileError if the path exists or the disk is too full, before
  /// anything is created. `earlier`: files whose tasks are copied; their rows of /runs come first.
  static ResultsFile create(const std::filesystem::path& path, const Plan& plan, const Provenance& provenance,
                            MPI_Comm comm, const FreeSpace& free_space = free_bytes,
                            const std::vector<std::filesystem::path>& earlier = {});
  /// Collective. Throws FileError for a file of another program, schema version, plan or job text, or one that another
  /// run is writing. All ranks verify the checksums, with a heartbeat, each until `verifying` says Verify::enough.
  /// Damaged tasks become pending again; with Retry::failed also failed ones that may end differently (may_change()).
  /// Appends a row to /runs, unless all tasks are complete and verified: then the file keeps its bytes, since jobs that
  /// read it as a data set know it by its hash. Returns none on all ranks, and leaves the file unchanged, after
  /// Verify::stop on any rank.
  static std::optional<ResultsFile> resume(
      const std::filesystem::path& path, const Plan& plan, const Provenance& provenance, MPI_Comm comm,
      Retry retry = Retry::none, const std::function<Verify()>& verifying = [] { return Verify::on; });

  ResultsFile(ResultsFile&&) noexcept;
  ResultsFile& operator=(ResultsFile&&) noexcept;
  /// Commits and closes. The close is collective, and is skipped during stack unwinding, when other ranks may never get
  /// here; nothing is lost, because writes are not buffered.
  ~ResultsFile();

  /// Complete tasks, by task index, when the file was opened.
  const std::vector<std::uint8_t>& done() const { return done_; }
  /// Per task, the number of tries in earlier runs whose worker crashed.
  const std::vector<std::uint8_t>& tries() const { return tries_; }
  int run_index() const { return run_index_; }  ///< this run's row of /runs; of a complete file, one without content
  /// A warning for the user about this file; may be empty.
  const std::string& note() const { return note_; }

  /// Independent; call before a rank runs a task. Counts the try and stores the rank.
  void begin(const Task& task);
  /// Independent: uncounts a try that was abandoned on request. Does not touch results, because another rank may run or
  /// have finished the task.
  void abandon(const Task& task);

  /// Independent: any rank, any task not done(), once. The task is complete after the next commit(); calls it if due.
  /// `origin`: who ran the task, if not this run. Within an Interruptible, an interruption ends the writing of a long
  /// record (InterruptedComputation); the task is then not complete.
  void write(const Task& task, const TaskRecord& record, const TaskOrigin* origin = nullptr);

  /// Independent: syncs this rank's tasks to disk, then marks them as complete.
  void commit();
  void commit_if_due();
  std::int64_t committed() const;  ///< number of tasks, of this rank in this run

  /// Independent, first rank: the heartbeat. Once a second it renews the file's modification time and stores the
  /// time left. Throws Hdf5Error if that fails; all results are still written as before.
  void beat(std::optional<double> left_s);

  /// Independent, one rank: stores the end of this run in its row of /runs.
  void end_run(const std::string& end_utc, int exit_code);

  /// Collective: commits, closes and syncs the file, and reports failure, unlike the destructor.
  void close();

  /// Independent; replaces close() if ranks were lost. Commits and syncs, but does not close the file.
  void leave();

  /// Independent; after close() or leave(). Throws FileError unless the written file is at its path and opens.
  void check_written() const;

 private:
  struct Open;
  ResultsFile(const std::filesystem::path& path, const Plan& plan, std::vector<std::uint8_t> done, int runs,
              std::vector<std::uint8_t> tries, const Provenance& provenance, MPI_Comm comm, FileLock lock,
              bool has_row);

  void add_note(const std::string& text);
  void write_run_row();
  void take_back(const std::vector<std::int64_t>& again, MPI_Comm comm);

  std::unique_ptr<Open> open_;
  std::vector<std::uint8_t> done_, tries_;
  std::map<std::int64_t, std::uint8_t> before_;  ///< earlier tries of the tasks that this rank runs
  bool has_row_ = true;                          ///< whether /runs gets a row of this run
  int run_index_ = 0;
  std::string note_;
  std::filesystem::path path_;  ///< after the end
  SyncedFile synced_;
};

}  // namespace rodsweep
