#include "runner/file/results_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "runner/file/columns.hpp"
#include "runner/file/file_lock.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/opening.hpp"
#include "runner/file/runs.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/plan/task_outcome.hpp"
#include "solver/linear/interruption.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// The hosts of all ranks without duplicates, in rank order. Collective.
std::string host_names(MPI_Comm comm) { return fmt::format("{}", fmt::join(gather_distinct(host_name(), comm), " ")); }

/// Writes a column of a task block by block. Subtracts the bytes from `bytes_left` of its record. If interrupted, throws
/// InterruptedComputation unless little is left.
void write_in_blocks(const hdf5::RowDataset& column, hid_t type, const RowRange& rows, std::string_view bytes,
                     std::size_t& bytes_left) {
  constexpr std::size_t block = 16 << 20, little = 64 << 20;
  constexpr double ns_per_byte = 2;
  const std::size_t row_bytes = bytes.size() / static_cast<std::size_t>(rows.count);
  const auto block_rows = static_cast<std::int64_t>(std::max<std::size_t>(1, block / row_bytes));
  for (std::int64_t done = 0; done < rows.count; done += block_rows) {
    const std::int64_t count = std::min(block_rows, rows.count - done);
    const std::size_t size = static_cast<std::size_t>(count) * row_bytes;
    column.write(type, static_cast<hsize_t>(rows.first + done), static_cast<hsize_t>(count),
                 bytes.data() + static_cast<std::size_t>(done) * row_bytes);
    bytes_left -= size;
    if (is_interrupted(static_cast<std::int64_t>(ns_per_byte * static_cast<double>(size))) && bytes_left > little)
      check_interrupted(0);
  }
}

constexpr double shortest_pause_s = 0.05, busy_share = 0.02;  // share of the time for syncs

}  // namespace

/// Handles of the file. They are destroyed in reverse order: datasets before their file.
struct ResultsFile::Open {
  ~Open() {
    try {
      commit();
    } catch (const std::exception&) {  // close() reports this; these tasks are run again
    }
    if (std::uncaught_exceptions() > 0) file.release();
  }

  void commit() {
    if (written.empty()) return;
    const auto begin = Clock::now();
    // The kernel reports a failed write only once; a second sync would succeed.
    if (std::exchange(sync_failed, true)) throw FileError("{}: an earlier sync failed", path.native());
    synced.sync();
    sync_failed = false;
    for (const std::int64_t task : written) rows.state.put<std::uint8_t>(task, 1);
    committed += static_cast<std::int64_t>(written.size());
    written.clear();
    const std::chrono::duration<double> took = Clock::now() - begin;
    const double pause = std::max(shortest_pause_s, took.count() / busy_share);
    next_commit = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
  }

  void put_origin(std::int64_t task, const TaskOrigin& by) {
    rows.rank.put(task, by.rank);
    rows.host.put_text(task, by.host);
    rows.run.put(task, by.run);
  }

  hdf5::File file;
  fs::path path;
  bool sync_failed = false;
  FileLock lock;  // on rank 0
  SyncedFile synced;
  FileHeartbeat heartbeat;
  Clock::time_point next_commit = Clock::now();
  std::vector<std::int64_t> written;  ///< tasks with written data, whose state byte is not set yet
  std::int64_t committed = 0;
  int own_rank = 0;
  AxisSizes sizes;
  RunRow run;                             // of this run
  std::vector<hdf5::RowDataset> columns;  // in the order of columns(); empty: not in the file
  TaskRows rows;
  hdf5::RowDataset left_s;
  std::string own_host = host_name();
};

ResultsFile::ResultsFile(ResultsFile&&) noexcept = default;
ResultsFile& ResultsFile::operator=(ResultsFile&&) noexcept = default;
ResultsFile::~ResultsFile() = default;

ResultsFile ResultsFile::create(const fs::path& path, const Plan& plan, const Provenance& provenance, MPI_Comm comm,
                                const FreeSpace& free_space, const std::vector<fs::path>& earlier) {
  int runs = 0;
  FileLock lock;
  check_common_place(path, comm);
  on_first_rank(comm, [&] {
    runs = create_results_file(path, plan, free_space, earlier);
    lock = FileLock(path);
  });
  runs = broadcast(runs, comm);
  const std::vector<std::uint8_t> none(static_cast<std::size_t>(plan.size()), 0);
  return ResultsFile(path, plan, none, runs, none, provenance, comm, std::move(lock), true);
}

std::optional<ResultsFile> ResultsFile::resume(const fs::path& path, const Plan& plan, const Provenance& provenance,
                                               MPI_Comm comm, Retry retry, const std::function<Verify()>& verifying) {
  check_common_place(path, comm);
  std::optional<ResumedFile> found = resume_file(path, plan, comm, retry, verifying);
  if (!found) return std::nullopt;
  // Without all tasks verified, the row makes the next run begin at another task.
  const bool has_row = !found->is_verified || !found->is_complete;
  ResultsFile file(path, plan, std::move(found->done), found->runs, std::move(found->tries), provenance, comm,
                   std::move(found->lock), has_row);
  file.take_back(found->again, comm);
  if (!found->note.empty()) file.add_note(found->note);
  return file;
}

ResultsFile::ResultsFile(const fs::path& path, const Plan& plan, std::vector<std::uint8_t> done, int runs,
                         std::vector<std::uint8_t> tries, const Provenance& provenance, MPI_Comm comm, FileLock lock,
                         bool has_row)
    : open_(std::make_unique<Open>()),
      done_(std::move(done)),
      tries_(std::move(tries)),
      has_row_(has_row),
      run_index_(std::min(runs, run_rows - 1)) {
  if (has_row_ && runs >= run_rows) {
    note_ = fmt::format("{} already has {} rows in /runs, the maximum: this run overwrites the last one", path.native(),
                        run_rows);
  }
  collectively(comm, [&] {
    const hdf5::PropertyList access(hdf5::check(H5Pcreate(H5P_FILE_ACCESS), "H5Pcreate"));
    hdf5::check(H5Pset_fapl_mpio(access.id(), comm, MPI_INFO_NULL), "H5Pset_fapl_mpio", path.native());
    open_->file = hdf5::open_file(path, H5F_ACC_RDWR, access.id());
    open_->path = path;
    open_->lock = std::move(lock);
    open_->synced = SyncedFile(path);
    open_->heartbeat = FileHeartbeat(path);
    open_->sizes = axis_sizes(plan);
    open_->own_rank = rank_in(comm);
    open_->rows = TaskRows(open_->file.id());
    open_->left_s = hdf5::RowDataset(open_->file.id(), "/runs/left_s");
    for (const Column& column : columns()) open_->columns.emplace_back(open_->file.id(), column.path);
  });
  if (open_->own_rank == 0 && !open_->lock.held())
    add_note(path.native() +
             " is on a file system without locks: a second run is detected only by the time of the file");
  open_->run.provenance = provenance;
  open_->run.provenance.host = host_names(comm);
  on_first_rank(comm, [&] { write_run_row(); });
}

void ResultsFile::write_run_row() {
  if (has_row_) write_run(open_->file, static_cast<std::size_t>(run_index_), open_->run);
}

/// Marks the tasks to run again as pending in the file, before anything is overwritten.
void ResultsFile::take_back(const std::vector<std::int64_t>& again, MPI_Comm comm) {
  if (again.empty()) return;
  on_first_rank(comm, [&] {
    for (const std::int64_t task : again) {
      open_->rows.state.put<std::uint8_t>(task, 0);
      open_->rows.tries.put<std::uint8_t>(task, 0);
    }
    open_->synced.sync();
  });
}

void ResultsFile::add_note(const std::string& text) { note_ += (note_.empty() ? "" : "; ") + text; }

void ResultsFile::commit() { open_->commit(); }

std::int64_t ResultsFile::committed() const { return open_->committed; }

void ResultsFile::commit_if_due() {
  if (!open_->written.empty() && Clock::now() >= open_->next_commit) open_->commit();
}

void ResultsFile::begin(const Task& task) {
  // Another rank may have been lost with this task since the file was opened.
  const std::uint8_t before =
      std::max(open_->rows.tries.number<std::uint8_t>(task.index), tries_.at(static_cast<std::size_t>(task.index)));
  before_[task.index] = before;
  open_->put_origin(task.index, {open_->own_rank, run_index_, open_->own_host, 0});
  open_->rows.tries.put<std::uint8_t>(task.index, before < UINT8_MAX ? before + 1 : before);
}

void ResultsFile::abandon(const Task& task) {
  open_->rows.tries.put(task.index, before_.at(task.index));
  before_.erase(task.index);
}

void ResultsFile::write(const Task& task, const TaskRecord& record, const TaskOrigin* origin) {
  const auto begin = Clock::now();
  Open& open = *open_;
  if (done_.at(static_cast<std::size_t>(task.index)) != 0) {
    throw std::logic_error(
        fmt::format("task {} is complete in {} and must not be written again", task.index, open.path.native()));
  }
  std::size_t bytes_left = 0;
  for (const Column& column : columns()) bytes_left += bytes_of(column, record).size();
  for (std::size_t c = 0; c < open.columns.size(); ++c) {
    const Column& column = columns()[c];
    const RowRange& rows = task.rows[column.rows];
    const std::string_view bytes = bytes_of(column, record);
    const auto values = static_cast<std::int64_t>(bytes.size() / H5Tget_size(column.type()));
    const std::int64_t expected = rows.count * row_width(column, open.sizes);
    if (values != expected) {
      throw std::logic_error(fmt::format("the record of task {} holds {} values for {}, not {}", task.index, values,
                                         column.path, expected));
    }
    if (expected > 0) write_in_blocks(open.columns[c], column.type(), rows, bytes, bytes_left);
  }
  open.rows.outcome.put_text(task.index, to_string(record.outcome));
  open.rows.message.put_text(task.index, record.message);
  open.rows.checksum.put(task.index, task_checksum(task.index, record));
  open.rows.tries.put<std::uint8_t>(task.index, 0);
  before_.erase(task.index);
  const TaskOrigin here{open.own_rank, run_index_, open.own_host,
                        std::chrono::duration<double>(Clock::now() - begin).count()};
  const TaskOrigin& by = origin != nullptr ? *origin : here;
  open.put_origin(task.index, by);
  open.rows.write_s.put(task.index, by.write_s);
  open.written.push_back(task.index);
  commit_if_due();
}

void ResultsFile::beat(std::optional<double> left_s) {
  if (!open_->heartbeat.beat()) return;
  open_->run.left_s = left_s.value_or(NAN);
  if (has_row_ && open_->left_s) open_->left_s.put(static_cast<hsize_t>(run_index_), open_->run.left_s);
}

void ResultsFile::end_run(const std::string& end_utc, int exit_code) {
  open_->run.end_utc = end_utc;
  open_->run.exit_code = exit_code;
  write_run_row();
}

void ResultsFile::close() {
  if (!open_) return;
  open_->commit();
  hdf5::File file = std::move(open_->file);
  path_ = open_->path;
  synced_ = std::move(open_->synced);
  const FileLock lock = std::move(open_->lock);
  open_.reset();
  hdf5::close(file, "H5Fclose", path_.native());
  synced_.sync();
}

void ResultsFile::leave() {
  open_->commit();
  path_ = open_->path;
  synced_ = std::move(open_->synced);
  synced_.sync();
  open_->file.release();
}

void ResultsFile::check_written() const {
  if (!synced_.is_in_place())
    throw FileError(
        "{} is not the file that this run wrote: meanwhile it was removed, moved or replaced. If it was moved, it is "
        "whole where it is now; if it was removed, its results are lost",
        path_.native());
  try {
    const hdf5::File file = hdf5::open_file(path_, H5F_ACC_RDONLY, hdf5::unlocked_access().id());
    const hdf5::RowDataset state(file.id(), "/tasks/state");
  } catch (const Hdf5Error& error) {
    throw FileError(
        "{} does not open after the run, because another program wrote to it meanwhile: run the job again with another "
        "-o FILE ({})",
        path_.native(), error.what());
  }
}

}  // namespace rodsweep
