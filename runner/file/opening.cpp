#include "runner/file/opening.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/file/task_reader.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/mpi/mpi_session.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Open MPI's file layer (4.1) copies the path to buffers of 256 bytes, and aborts if they overflow.
void check_length(const fs::path& path) {
  constexpr std::size_t most = 230;
  if (path.native().size() > most)
    throw FileError(
        "{}: the path has {} bytes; must be at most {} for MPI-IO: name a shorter path with -o FILE, for example from "
        "its folder",
        path.native(), path.native().size(), most);
}

/// Creates a file with a new name, which no host can have cached. Leaves `token` empty in a folder that is read-only, as
/// that of a file to resume may be: then the ranks look for that file.
void create_in_folder_of(const fs::path& path, std::optional<UnfinishedFile>& token) {
  try {
    token.emplace(path).create();
  } catch (const FileError&) {
    token.reset();
    if (!fs::exists(path)) throw;
  }
}

/// Why a task marked as complete is run again.
enum Again : std::uint8_t { not_again, failed, damaged };

/// Sets invalid state bytes to 0, so that their tasks are pending.
void mend_states(const fs::path& path, const std::vector<std::uint8_t>& states) {
  if (std::all_of(states.begin(), states.end(), [](std::uint8_t state) { return state <= 1; })) return;
  const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDWR);
  for (std::size_t task = 0; task < states.size(); ++task)
    if (states[task] > 1) hdf5::RowDataset(file.id(), "/tasks/state").put<std::uint8_t>(task, 0);
}

/// For file systems without locks: throws FileError if the last run has not ended and its heartbeat is recent.
void refuse_living(const fs::path& path) {
  const std::vector<RunRow> runs = read_runs(open_results(path));
  const double silent_s = silent_seconds(path);
  if (runs.empty() || !runs.back().end_utc.empty() || silent_s > alive_s) return;
  throw FileError(
      "{} seems to be in use by another run: its last activity was {:.0f} s ago (this file system has no locks); wait "
      "until it ends, or, if it was killed, for {:.0f} s without activity",
      path.native(), silent_s, alive_s);
}

bool intact(const TaskReader& reader, std::int64_t task, TaskRecord& record, const fs::path& path) try {
  return reader.read_intact(task, record);
} catch (const std::bad_alloc&) {
  throw FileError(
      "{}: the results of task {} exceed the memory limit of this process and cannot be verified: use fewer ranks per "
      "host, or raise --memory-limit-gb",
      path.native(), task);
}

struct Verified {
  std::vector<std::uint8_t> again;  ///< for each task, whether it is run again and why
  std::int64_t left_out = 0;        ///< finished tasks that were not verified
};

/// Collective. Begins at another task in each run, so that runs which have time for a part verify all in the end.
/// Returns none if `verifying` is Verify::stop on any rank.
std::optional<Verified> to_run_again(const fs::path& path, const Plan& plan, const ResumePoint& point, Retry retry,
                                     MPI_Comm comm, const std::function<Verify()>& verifying) {
  const int rank = rank_in(comm), size = ranks_in(comm);
  const std::vector<std::uint8_t>& done = point.done;
  constexpr double golden = 0.618033988749895;
  const auto first = static_cast<std::size_t>(std::fmod(golden * point.runs, 1) * static_cast<double>(done.size()));
  Verified verified;
  verified.again.assign(done.size(), not_again);
  std::uint8_t stopped = 0;
  collectively(comm, [&] {
    const TaskReader reader(path, TaskReader::Times::left_out, &plan.tasks());
    FileHeartbeat heartbeat(path);
    TaskRecord record;
    Verify state = Verify::on;
    for (auto k = static_cast<std::size_t>(rank); k < done.size(); k += static_cast<std::size_t>(size)) {
      const std::size_t i = (first + k) % done.size();
      const auto task = static_cast<std::int64_t>(i);
      if (done[i] > 1) verified.again[i] = damaged;
      if (done[i] != 1) continue;
      if (state == Verify::on) {
        if (rank == 0) heartbeat.beat();
        state = verifying();
      }
      if (state == Verify::stop) {
        stopped = 1;
        return;
      }
      if (state == Verify::enough) ++verified.left_out;
      if (state == Verify::on && !intact(reader, task, record, path))
        verified.again[i] = damaged;
      else if (retry == Retry::failed && may_change(reader.outcome(task)))
        verified.again[i] = failed;
    }
  });
  verified.again.push_back(stopped);
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, verified.again.data(), static_cast<int>(verified.again.size()), MPI_UINT8_T,
                          MPI_MAX, comm),
            "MPI_Allreduce");
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, &verified.left_out, 1, MPI_INT64_T, MPI_SUM, comm), "MPI_Allreduce");
  if (verified.again.back() != 0) return std::nullopt;
  verified.again.pop_back();
  return verified;
}

/// "task 3 is" or "4 tasks, the first being 3, are"; empty if there are none.
std::string these_tasks(const std::vector<std::uint8_t>& again, Again why) {
  const auto count = std::count(again.begin(), again.end(), why);
  if (count == 0) return "";
  const auto first = std::find(again.begin(), again.end(), why) - again.begin();
  return count == 1 ? fmt::format("task {} is", first) : fmt::format("{} tasks (first: {}) are", count, first);
}

/// What is run again and why, and whether tasks were not verified.
std::string note_of(const fs::path& path, const Verified& verified, std::int64_t finished) {
  std::vector<std::string> notes;
  const auto add = [&](Again why, const char* text) {
    const std::string tasks = these_tasks(verified.again, why);
    if (!tasks.empty()) notes.push_back(fmt::format("{}: {} run again, {}", path.native(), tasks, text));
  };
  add(damaged, "because of a wrong checksum");
  add(failed, "after an error, a timeout or a crash");
  if (verified.left_out > 0)
    notes.push_back(fmt::format("{}: time was left to verify {} of {} finished tasks; later runs verify others",
                                path.native(), finished - verified.left_out, finished));
  return fmt::format("{}", fmt::join(notes, "; "));
}

}  // namespace

void check_common_place(const fs::path& path, MPI_Comm comm) {
  std::optional<UnfinishedFile> token;
  std::string name = path.filename().native();
  on_first_rank(comm, [&] {
    check_length(path);
    make_folder_of(path);
    create_in_folder_of(path, token);
    if (token) name = token->path().filename().native();
  });
  name = broadcast(std::move(name), comm);
  std::error_code error;
  const bool found = fs::exists(path.parent_path() / name, error);
  const std::vector<std::string> hosts = gather_distinct(found ? "" : host_name(), comm);
  if (hosts.empty()) return;
  throw FileError(
      "{}: ranks on {} do not find there what rank 0 writes: name a file in a folder that all hosts share with -o "
      "FILE; relative paths start at the current folder of each rank",
      path.native(), fmt::join(hosts, ", "));
}

void on_first_rank(MPI_Comm comm, const std::function<void()>& work) try {
  by_rank_0(comm, work);
} catch (const CollectiveError& error) {
  throw FileError(error.what());
}

std::optional<ResumedFile> resume_file(const fs::path& path, const Plan& plan, MPI_Comm comm, Retry retry,
                                       const std::function<Verify()>& verifying) {
  ResumePoint point;
  FileLock lock;
  on_first_rank(comm, [&] {
    lock = FileLock(path);
    point = check_resumable(path, plan);
    if (!lock.held()) refuse_living(path);
    mend_states(path, point.done);
  });
  broadcast(point.done, comm);
  broadcast(point.tries, comm);
  point.runs = broadcast(point.runs, comm);

  const auto verified = to_run_again(path, plan, point, retry, comm, verifying);
  if (!verified) return std::nullopt;
  const std::int64_t finished = std::count(point.done.begin(), point.done.end(), 1);
  std::vector<std::int64_t> again;
  for (std::size_t i = 0; i < point.done.size(); ++i) {
    const bool is_again = verified->again[i] != not_again;
    if (is_again) again.push_back(static_cast<std::int64_t>(i));
    if (is_again) point.done[i] = 0;
    if (is_again || retry == Retry::failed) point.tries[i] = 0;
  }
  const bool is_complete = std::find(point.done.begin(), point.done.end(), 0) == point.done.end();
  return ResumedFile{std::move(lock),
                     std::move(point.done),
                     std::move(point.tries),
                     std::move(again),
                     point.runs,
                     verified->left_out == 0,
                     is_complete,
                     note_of(path, *verified, finished)};
}

}  // namespace rodsweep
