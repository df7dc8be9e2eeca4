// Results files, as status, info --verify, query, rerun, merge and --resume read them.
#include "runner/file/inspect.hpp"
#include "runner/file/resume_check.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/file/task_table.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "tests/fuzz/file_edits.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const MpiSession& mpi = *new MpiSession;  // until the process ends, whose end libFuzzer brings about
  static_cast<void>(mpi);
  static const std::filesystem::path folder = fuzz::scratch_folder(), path = folder / "edited.h5";
  static const Plan plan = plan_of(full_job());
  static const fuzz::Original original = [] {
    make_file(folder / "original.h5", plan, 4);
    return fuzz::Original(folder / "original.h5");
  }();
  original.edited(path, data, size);
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  fuzz::expect_plain(path, input, [] { inspect(path); });
  fuzz::expect_plain(path, input, [] { verify(path); });
  fuzz::expect_plain(path, input, [] {
    const TaskTable table(path);
    for (const TaskColumn& column : table.columns()) table.read(column);
  });
  fuzz::expect_plain(path, input, [] { check_resumable(path, plan); });
  fuzz::expect_plain(path, input, [] { check_same_plan(path, stored_plan(inspect(path)), "Advice"); });
  return 0;
}
