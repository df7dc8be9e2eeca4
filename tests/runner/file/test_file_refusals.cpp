#include <fcntl.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <limits>

#include "runner/file/hdf5.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/stored_plan.hpp"
#include "tests/catch.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

namespace test_file_refusals {

namespace fs = std::filesystem;

std::string creation_refusal(const fs::path& path, const Plan& plan, const FreeSpace& space = free_bytes) {
  return message_of<FileError>([&] { ResultsFile::create(path, plan, test_provenance(), MPI_COMM_SELF, space); });
}

std::string resume_refusal(const fs::path& path, const Plan& plan) {
  const std::string before = fs::is_regular_file(path) ? bytes_of(path) : "";
  const std::string text =
      message_of<FileError>([&] { ResultsFile::resume(path, plan, test_provenance(), MPI_COMM_SELF); });
  const bool untouched = !fs::is_regular_file(path) || bytes_of(path) == before;
  CHECK(untouched == !text.empty());
  return text;
}

std::string inspect_refusal(const fs::path& path) {
  return message_of<FileError>([&] { inspect(path); });
}

TEST_CASE("a file that exists is refused, untouched, with the two ways on") {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.h5") << "precious";
  const std::string path = (folder / "a.h5").native();
  CHECK(creation_refusal(path, plan_of(full_job())) ==
        path +
            " exists already and is never overwritten: continue it with --resume, or name another file with -o FILE");
  CHECK(bytes_of(path) == "precious");
  CHECK(entries(folder.path()) == 1);
  fs::create_symlink(folder / "nowhere", folder / "dangling.h5");
  CHECK_THAT(creation_refusal(folder / "dangling.h5", plan_of(full_job())), ContainsSubstring("exists already"));
}

TEST_CASE("a file that appears while ours is being made is not replaced") {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.h5";
  const std::string text = creation_refusal(path, plan_of(full_job()), [&](const fs::path& where) {
    std::ofstream(path) << "another's";
    return free_bytes(where);
  });
  CHECK_THAT(text, ContainsSubstring("exists already and is never overwritten"));
  CHECK(bytes_of(path) == "another's");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("a disk that is too full is refused before anything is created") {
  const TemporaryFolder folder;
  const std::string text =
      creation_refusal(folder / "a.h5", plan_of(full_job()), [](const fs::path&) { return std::uintmax_t{12345}; });
  CHECK_THAT(text, StartsWith((folder / "a.h5").native() + " needs ") &&
                       ContainsSubstring("kB, but only 12.3 kB are free in " + folder.path().native()) &&
                       ContainsSubstring("-o FILE") && ContainsSubstring("record.solves"));
  CHECK(entries(folder.path()) == 0);
}

TEST_CASE("a folder that cannot be made or written is refused") {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "x";
  CHECK_THAT(creation_refusal(folder / "file/a.h5", plan_of(full_job())),
             ContainsSubstring("file/a.h5 cannot be created") && ContainsSubstring("Not a directory"));
  CHECK(creation_refusal(folder / "new/folder/a.h5", plan_of(full_job())) == "");
  CHECK(fs::exists(folder / "new/folder/a.h5"));
}

TEST_CASE("a path that the system or MPI-IO cannot take is refused with the reason") {
  const TemporaryFolder folder;
  CHECK_THAT(creation_refusal(folder / (std::string(300, 'a') + ".h5"), plan_of(full_job())),
             ContainsSubstring("must be at most 230") && ContainsSubstring("-o FILE"));
  const fs::path longest = folder / (std::string(200 - folder.path().native().size(), 'b') + "/" + "c/d/e/f/g/h.h5");
  CHECK(creation_refusal(longest, plan_of(full_job())) == "");
  CHECK(fs::exists(longest));
  CHECK_THAT(resume_refusal(folder / std::string(231, 'a'), plan_of(full_job())), ContainsSubstring("at most 230"));
  std::error_code error;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec, error);
  if (geteuid() != 0) {  // root can write anywhere
    const std::string text = creation_refusal(folder / "a.h5", plan_of(full_job()));
    CHECK(text == (folder / "a.h5").native() + " cannot be created: Permission denied");
  }
  fs::permissions(folder.path(), fs::perms::owner_all, error);
}

TEST_CASE("what is not a results file is refused with what it is") {
  const TemporaryFolder folder;
  std::ofstream(folder / "text.h5") << "no HDF5 at all";
  { hdf5::create_file(folder / "foreign.h5"); }
  std::ofstream(folder / "empty.h5");
  const Plan plan = plan_of(full_job());
  for (const auto& refusal : {+[](const fs::path&path, const Plan&p) { return resume_refusal(path, p); },
                              +[](const fs::path&path, const Plan&) { return inspect_refusal(path); }}) {
    const auto text = [&](const std::string& name) {
      std::string message = refusal(folder / name, plan);
      REQUIRE_THAT(message, StartsWith((folder / name).native()));
      return message.substr((folder / name).native().size());
    };
    CHECK(text("missing.h5") == ": file not found");
    CHECK(text("text.h5") == " is not an HDF5 file");
    CHECK(text("empty.h5") == " is not an HDF5 file");
    CHECK(text("foreign.h5") == " is an HDF5 file, but does not hold rodsweep results");
    CHECK(text("") == " is not a file");
  }
}

TEST_CASE("a damaged results file, or one of another program, is refused with what is wrong") {
  const auto at_inspection = [](const fs::path& path, const Plan&) { return inspect_refusal(path); };
  const auto at_verification = [](const fs::path& path, const Plan&) {
    return message_of<FileError>([&] { verify(path); });
  };
  struct Damage {
    std::function<void(hid_t)> change;
    std::function<std::string(const fs::path&, const Plan&)> refusal;
    const char* says;
  };
  const auto otherwise_written = [](hid_t file) {
    std::string text = hdf5::read_all<std::string>(file, "/job/text").at(0);
    text.at(text.find("\"seed\": ") + 8) = '7';
    hdf5::write_all(file, "/job/text", {text});
  };
  const Damage damages[] = {
      {[](hid_t file) { H5Ldelete(file, "/tasks/state", H5P_DEFAULT); }, at_inspection, "/tasks/state"},
      {[](hid_t file) { hdf5::RowDataset(file, "/tasks/state").put<std::uint8_t>(4, 7); }, at_inspection,
       "/tasks/state of task 4 is 7; must be 0 or 1"},
      {[](hid_t file) {
         hdf5::RowDataset(file, "/tasks/frames").put<std::int64_t>(0, std::numeric_limits<std::int64_t>::max());
       },
       at_verification, "a task has rows outside /trajectories"},
      {[](hid_t file) { set_attribute(file, "/", "schema_version", 99); }, at_inspection,
       "has schema version 99, but this rodsweep reads only version 2"},
      {otherwise_written, at_inspection, "its job does not match its checksum (/job/text)"},
      {otherwise_written, resume_refusal, "its job does not match its checksum"},
  };
  for (const Damage& damage : damages) {
    const FullFile made(3);
    damage.change(hdf5::open_file(made.path, H5F_ACC_RDWR).id());
    CHECK_THAT(damage.refusal(made.path, made.plan), StartsWith(made.path.native()) && ContainsSubstring(damage.says));
  }
  const FullFile cut(2);
  fs::resize_file(cut.path, fs::file_size(cut.path) / 2);
  CHECK_THAT(inspect_refusal(cut.path),
             ContainsSubstring("a.h5 is damaged or incomplete") && ContainsSubstring("truncated file"));
  CHECK_THAT(resume_refusal(cut.path, cut.plan), ContainsSubstring("a.h5 is damaged or incomplete"));
}

TEST_CASE("a task whose state byte is damaged is run again") {
  const FullFile made(2);
  hdf5::RowDataset(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), "/tasks/state").put<std::uint8_t>(4, 7);
  const auto file = ResultsFile::resume(made.path, made.plan, test_provenance(), MPI_COMM_SELF);
  CHECK_THAT(file.value().note(), ContainsSubstring("task 4 is run again"));
  CHECK(file.value().done().at(4) == 0);
  CHECK(inspect(made.path).pending >= 1);
}

TEST_CASE("resume with another job is refused with the key that differs, and which option does it if any") {
  const TemporaryFolder folder;
  const Json job = full_job();
  make_file(folder / "a.h5", plan_of(job), 3);
  const auto refused = [&](const char* pointer, const char* value) {
    return resume_refusal(folder / "a.h5", plan_of(with(pointer, value, job)));
  };
  CHECK_THAT(refused("/seed", "4"), ContainsSubstring("a.h5 holds the results of another job than job.json") &&
                                        ContainsSubstring("seed was 3 and is 4") &&
                                        ContainsSubstring("rodsweep info FILE --job") && ContainsSubstring("-o FILE"));
  CHECK_THAT(refused("/samples", "3"), ContainsSubstring("samples was") && ContainsSubstring("--extend"));
  CHECK_THAT(refused("/task_time_limit_s", "100"), ContainsSubstring("--task-time-limit"));
  CHECK_THAT(refused("/time/steps", "4"),
             ContainsSubstring("time.steps was") && ContainsSubstring("A task cannot go on beyond its last step"));
}

TEST_CASE("the same job written in another way is continued: order of keys, form of numbers, name, description") {
  const TemporaryFolder folder;
  auto job = full_job();
  make_file(folder / "a.h5", Plan(parse_job(job.dump(2), "job.json")), 3);
  job["name"] = "renamed";
  job["description"] = "another";
  job["seed"] = static_cast<double>(job["seed"].get<int>());
  std::string text = nlohmann::json(job).dump(1);  // sorted keys
  for (std::size_t i = 0; (i = text.find('\n', i)) != std::string::npos; i += 2) text.replace(i, 1, "\r\n");
  const Plan plan(parse_job(text, "elsewhere.json"));
  CHECK_NOTHROW(check_resumable(folder / "a.h5", plan));
}

TEST_CASE("resume with a program that expands the job differently is refused with the difference") {
  const FullFile made(3);
  const std::string length = "/tasks/parameters/scene.length_m";
  auto lengths = hdf5::read_all<double>(hdf5::open_file(made.path, H5F_ACC_RDONLY).id(), length);

  SECTION("another value of a parameter") {
    lengths[4] *= 1.001;
    hdf5::write_all(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), length, lengths);
    const std::string own = source_revision();
    const bool is_known = own != "unknown" && own.find("-dirty") == std::string::npos;
    CHECK_THAT(resume_refusal(made.path, made.plan),
               ContainsSubstring("scene.length_m of task 4 is") &&
                   ContainsSubstring(is_known ? "the revision is the same" : "expands the job differently"));
    hdf5::RowDataset(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), "/runs/revision").put_text(0, "0123456789ab");
    CHECK_THAT(resume_refusal(made.path, made.plan),
               ContainsSubstring("expands the job differently (revision 0123456789ab): scene.length_m of task 4 is"));
  }
  SECTION("last digits of a parameter do not matter") {
    lengths[4] *= 1 + 1e-14;
    hdf5::write_all(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), length, lengths);
    CHECK(resume_refusal(made.path, made.plan) == "");
  }
  SECTION("another list of tasks") {
    set_attribute(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), "/job", "plan_hash", "0123456789abcdef");
    CHECK_THAT(resume_refusal(made.path, made.plan), ContainsSubstring("/job, plan_hash"));
  }
}

TEST_CASE("the file of one task run again is not continued") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "one.h5", plan.alone(3, 1), 1);
  CHECK(inspect(folder / "one.h5").rerun_of_task == 3);
  CHECK_THAT(resume_refusal(folder / "one.h5", plan),
             ContainsSubstring("holds only one task of a sweep, from `rodsweep rerun`"));
}

TEST_CASE("a sweep does not go on with another file under a name in its job") {
  const TemporaryFolder folder;
  const auto plan = [&] {
    const Json job = with("/guesses", R"(["zero", {"knn": {"data": "data.h5"}}])", full_job());
    return Plan(parse_job(job.dump(), folder / "job.json"));
  };
  std::ofstream(folder / "data.h5") << "systems";
  make_file(folder / "a.h5", plan(), 3);
  CHECK(resume_refusal(folder / "a.h5", plan()) == "");
  std::ofstream(folder / "data.h5") << "other systems";
  CHECK_THAT(resume_refusal(folder / "a.h5", plan()), ContainsSubstring("input files of the job have changed"));
}

}  // namespace test_file_refusals
