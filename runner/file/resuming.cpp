#include "runner/file/resuming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "runner/file/common_place.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/heartbeat.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/resume_check.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/task_reader.hpp"
#include "runner/mpi/mpi_session.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Why a task marked as complete is run again.
enum Again : std::uint8_t { not_again, failed, damaged };

/// Sets invalid state bytes to 0, so that their tasks are pending.
void mend_states(const fs::path& path, const std::vector<std::uint8_t>& states) {
  if (std::all_of(states.begin(), states.end(), [](std::uint8_t state) { return state <= 1; })) return;
  const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDWR);
  for (std::size_t task = 0; task < states.size(); ++task)
    if (states[task] > 1) hdf5::write_row<std::uint8_t>(file.id(), "/tasks/state", task, 0);
}

/// For file systems without locks: throws FileError if the last run has not ended and its heartbeat is recent.
void refuse_living(const fs::path& path) {
  const std::vector<RunRow> runs = read_runs(open_results(path));
  const double silent_s = silent_seconds(path);
  if (runs.empty() || !runs.back().end_utc.empty() || silent_s > alive_s) return;
  throw FileError(
      fmt::format("{} seems to be in use by another run: its last activity was {:.0f} s ago (this file system has no "
                  "locks); wait until it ends, or, if it was killed, for {:.0f} s without activity",
                  path.native(), silent_s, alive_s));
}

bool intact(const TaskReader& reader, std::int64_t task, TaskRecord& record, const fs::path& path) try {
  return reader.read_intact(task, record);
} catch (const std::bad_alloc&) {
  throw FileError(
      fmt::format("{}: the results of task {} exceed the memory limit of this process and cannot be verified: use "
                  "fewer ranks per host, or raise --memory-limit-gb",
                  path.native(), task));
}

struct Verified {
  std::vector<std::uint8_t> again;  ///< for each task, whether it is run again and why
  std::int64_t left_out = 0;        ///< finished tasks that were not verified
};

/// Collective. Begins at another task in each run, so that runs which have time for a part verify all in the end.
/// Returns none if `verifying` is Verify::stop on any rank.
std::optional<Verified> to_run_again(const fs::path& path, const Plan& plan, const ResumePoint& point, Retry retry,
                                     MPI_Comm comm, const std::function<Verify()>& verifying) {
  int rank = 0, size = 1;
  check_mpi(MPI_Comm_rank(comm, &rank), "MPI_Comm_rank");
  check_mpi(MPI_Comm_size(comm, &size), "MPI_Comm_size");
  const std::vector<std::uint8_t>& done = point.done;
  constexpr double golden = 0.618033988749895;
  const auto first = static_cast<std::size_t>(std::fmod(golden * point.runs, 1) * static_cast<double>(done.size()));
  Verified verified;
  verified.again.assign(done.size(), not_again);
  std::uint8_t stopped = 0;
  collectively(comm, [&] {
    const TaskReader reader(path, TaskReader::Times::left_out, plan.tasks());
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
