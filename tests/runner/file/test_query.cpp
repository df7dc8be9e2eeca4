// Tasks by parameter or result: columns, conditions, and the three ways to write them.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "runner/command/query_condition.hpp"
#include "runner/command/query_output.hpp"
#include "runner/file/task_table.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::Contains;

namespace {

/// Six tasks of 4, 4, 5, 5, 7, 7 segments, of which the first four are done; the guesses are zero and previous.
struct PartlyDone {
  PartlyDone() : plan(plan_of(full_job())), path(folder / "a.h5") { make_file(path, plan, 4); }

  std::vector<std::int64_t> matching(const std::string& text) const {
    const TaskTable table(path);
    const Condition condition = parse_condition(text, table);
    const ColumnValues values = table.read(condition.column);
    std::vector<std::int64_t> tasks;
    for (std::int64_t task = 0; task < table.size(); ++task)
      if (condition.met(values, static_cast<std::size_t>(task))) tasks.push_back(task);
    return tasks;
  }

  std::string refusal(const std::string& text) const {
    return message_of<FileError>([&] { parse_condition(text, TaskTable(path)); });
  }

  std::string written(QueryOptions::Format format, const std::vector<std::string>& names,
                      const std::vector<std::int64_t>& tasks) const {
    const TaskTable table(path);
    std::vector<ColumnValues> values;
    std::vector<ShownColumn> columns;
    for (const std::string& name : names) values.push_back(table.read(table.column(name)));
    for (std::size_t i = 0; i < names.size(); ++i) columns.push_back({table.column(names[i]), &values[i]});
    std::string text;
    write_tasks(format, columns, tasks, [&](std::string_view piece) { text += piece; });
    return text;
  }

  TemporaryFolder folder;
  Plan plan;
  std::filesystem::path path;
};

using Tasks = std::vector<std::int64_t>;

}  // namespace

TEST_CASE("numbers are compared, listed, and met up to rounding") {
  const PartlyDone file;
  CHECK(file.matching("scene.segments>=5") == Tasks{2, 3, 4, 5});
  CHECK(file.matching("scene.segments>5") == Tasks{4, 5});
  CHECK(file.matching("scene.segments <= 4") == Tasks{0, 1});
  CHECK(file.matching("scene.segments<5") == Tasks{0, 1});
  CHECK(file.matching("scene.segments=4,7") == Tasks{0, 1, 4, 5});
  CHECK(file.matching("scene.segments!=4,7") == Tasks{2, 3});
  CHECK(file.matching("scene.segments=5:") == Tasks{2, 3, 4, 5});
  CHECK(file.matching("scene.segments!=4:5,9") == Tasks{4, 5});
  CHECK(file.matching("time.step_s==0.0200000000001") == Tasks{0, 1, 2, 3, 4, 5});
  CHECK(file.matching("time.step_s=0.02001").empty());
  CHECK(file.matching("task=3") == Tasks{3});
  CHECK(file.matching("scene.gravity_m_s2.y=-9.81").size() == 6);
}

TEST_CASE("conditions are met and refused as the table says that the scripts of analysis/ are held to, too") {
  std::ifstream stream(RODSWEEP_CONDITIONS);
  const Json cases = Json::parse(stream);
  const PartlyDone file;
  {
    const hdf5::File h5 = hdf5::open_file(file.path, H5F_ACC_RDWR);
    for (const auto& [name, column] : cases["columns"].items()) {
      const std::string kind = column.begin().key(), path = "/tasks/parameters/" + name;
      const Json& values = column.begin().value();
      std::vector<double> numbers;
      std::vector<std::string> texts;
      for (const Json& value : values) {
        if (kind == "text") texts.push_back(value.is_null() ? "" : value.get<std::string>());
        if (kind == "whole") numbers.push_back(value.is_null() ? -1 : value.get<double>());
        if (kind == "real") numbers.push_back(value.is_null() ? std::nan("") : value.get<double>());
      }
      const hid_t number = kind == "whole" ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE;
      hdf5::create_dataset(h5.id(), path, kind == "text" ? hdf5::text_type(32).id() : number, {values.size()});
      if (kind == "text")
        hdf5::write_texts(h5.id(), path, texts);
      else
        hdf5::write_all(h5.id(), path, numbers);
    }
  }
  for (const auto& [text, tasks] : cases["met"].items()) {
    INFO(text);
    CHECK(file.matching(text) == tasks.get<Tasks>());
  }
  for (const auto& [text, words] : cases["refused"].items()) {
    INFO(text);
    CHECK_THAT(file.refusal(text), Contains(words.get<std::string>()));
  }
}

TEST_CASE("texts are equal, different, or contain") {
  const PartlyDone file;
  CHECK(file.matching("scene.type=bending_rod,helix").size() == 6);
  CHECK(file.matching("scene.type!=bending_rod").empty());
  CHECK(file.matching("scene.type~ending").size() == 6);
  CHECK(file.matching("state=pending") == Tasks{4, 5});
  CHECK(file.matching("state!=pending") == Tasks{0, 1, 2, 3});
  CHECK(file.matching("outcome=ok") == Tasks{0, 1, 2, 3});
  CHECK(file.matching("outcome!=ok") == Tasks{4, 5});
}

TEST_CASE("a result of a task that is not done is not there and meets no condition") {
  const PartlyDone file;
  CHECK(file.matching("steps_done>=0") == Tasks{0, 1, 2, 3});
  CHECK(file.matching("steps_done!=-5") == Tasks{0, 1, 2, 3});
  const TaskTable table(file.path);
  const ColumnValues values = table.read(table.column("cg_ratio.previous"));
  CHECK(std::isfinite(values.numbers[3]));
  CHECK(std::isnan(values.numbers[4]));
  CHECK(table.read(table.column("outcome")).texts[5] == "pending");
}

TEST_CASE("a key of another scene meets no condition, be it equal or different") {
  Json job = full_job();
  job["scene"] = grid({bending_scene(), helix_scene()});
  job["samples"] = 1;
  PartlyDone file;
  file.plan = plan_of(job);
  file.path = file.folder / "two.h5";
  make_file(file.path, file.plan, 0);
  CHECK(file.matching("scene.windings=2") == Tasks{1});
  CHECK(file.matching("scene.windings!=3") == Tasks{1});
  CHECK(file.matching("scene.length_m>0") == Tasks{0});
}

TEST_CASE("counts and ratios of a guess are those at the job's tolerance unless another is named") {
  const PartlyDone file;
  const TaskTable table(file.path);
  CHECK(table.headline() == 1e-2);
  CHECK(table.column("cg_ratio.previous").element == 8 + 1);
  CHECK(table.column("cg_ratio.previous@1e-4").element == 8 + 3);
  CHECK(table.column("cg_ratio.previous@0.0001").name == "cg_ratio.previous@1e-4");
  CHECK(table.read(table.column("cg_ratio.zero@1e-1")).numbers[0] ==
        synthetic_record(file.plan, 0).counted.cg_ratio.front());
  CHECK_THAT(message_of<FileError>([&] { table.column("cg_ratio.previous@0.5"); }),
             Contains("its tolerances are 1e-1, 1e-2, 1e-3"));
}

TEST_CASE("the headline tolerance is that of the job's solves where it is on the ladder") {
  const TemporaryFolder folder;
  for (const auto& [solve, headline] :
       {std::pair("1e-4", 1e-4), std::pair("0.03", 1e-2), std::pair(R"({"grid": [1e-3, 1e-4]})", 1e-2)}) {
    const Plan plan = plan_of(with("/solve", R"({"tolerance": )" + std::string(solve) + "}"));
    const auto path = folder / (std::string(solve).substr(0, 3) + ".h5");
    make_file(path, plan, 0);
    CHECK(TaskTable(path).headline() == headline);
  }
}

TEST_CASE("labels with operators in them can be asked for") {
  Json job = full_job();
  job["guesses"] = Json::parse(R"(["zero", {"previous": {"label": "a<=b, c=1"}}])");
  PartlyDone file;
  file.plan = plan_of(job);
  file.path = file.folder / "labels.h5";
  make_file(file.path, file.plan, 2);
  CHECK(file.matching("cg_ratio.a<=b, c=1>=0") == Tasks{0, 1});
}

TEST_CASE("in a closed loop the guess of a task is its label") {
  Json job = full_job();
  job["evaluation"] = "closed_loop";
  PartlyDone file;
  file.plan = plan_of(job);
  file.path = file.folder / "closed.h5";
  make_file(file.path, file.plan, 0);
  CHECK(TaskTable(file.path).has_own_guesses());
  CHECK(file.matching("own_guess=previous") == Tasks{1, 3, 5, 7, 9, 11});
  CHECK_THAT(file.refusal("own_guess=previus"), Contains("did you mean \"previous\"?"));
}

TEST_CASE("what cannot be asked is refused with what can") {
  const PartlyDone file;
  const std::string path = file.path.native();
  CHECK(file.refusal("scene.segmants>=30") ==
        path + " has no column \"scene.segmants\"; did you mean \"scene.segments\"? (--columns help lists them all)");
  CHECK_THAT(file.refusal("length_m>2"), Contains("did you mean \"scene.length_m\"?"));
  CHECK(file.refusal("scene.segments>=many") ==
        "\"scene.segments>=many\": scene.segments holds numbers, and \"many\" is none");
  CHECK_THAT(file.refusal("scene.segments=4,,7"), Contains("\"\" is none"));
  CHECK_THAT(file.refusal("scene.segments~4"), Contains("~ is for texts"));
  CHECK(file.refusal("scene.type<helix") ==
        "\"scene.type<helix\": scene.type holds texts, which have no order; use =, != or ~");
  CHECK_THAT(file.refusal("outcome=divergd"), Contains("outcome is never \"divergd\"; did you mean \"diverged\"?"));
  CHECK_THAT(file.refusal("state=over"), Contains("it is one of \"done\", \"pending\""));
  CHECK_THAT(file.refusal("segments"), Contains("\"segments\" is no condition: write COLUMN=VALUE"));
  CHECK_THAT(file.refusal("=3"), Contains("is no condition"));
}

TEST_CASE("a table is aligned, numbers to the right, with a dash for what is not there") {
  const PartlyDone file;
  CHECK(file.written(QueryOptions::Format::table, {"task", "scene.type", "steps_done", "outcome"}, {3, 4}) ==
        "task  scene.type   steps_done  outcome\n"
        "   3  bending_rod          " +
            fmt::format("{:>2}", synthetic_record(file.plan, 3).steps_done[0]) +
            "  ok\n"
            "   4  bending_rod           -  pending\n");
}

TEST_CASE("CSV has every digit and quotes what needs it") {
  Json job = full_job();
  job["scene"]["length_m"] = 0.1 + 0.2;
  job["samples"] = 1;
  job["guesses"] = Json::parse(R"(["zero", {"previous": {"label": "say \"hi\", you"}}])");
  PartlyDone file;
  file.plan = plan_of(job);
  file.path = file.folder / "b.h5";
  make_file(file.path, file.plan, 0);
  CHECK(file.written(QueryOptions::Format::csv, {"task", "scene.length_m", "cg_ratio.say \"hi\", you"}, {0}) ==
        "task,scene.length_m,\"cg_ratio.say \"\"hi\"\", you\"\n0,0.30000000000000004,\n");
}

TEST_CASE("JSON is a list of objects with null for what is not there") {
  const PartlyDone file;
  const std::string text =
      file.written(QueryOptions::Format::json, {"task", "scene.length_m", "steps_done", "outcome"}, {3, 4});
  const Json rows = Json::parse(text);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0]["task"] == 3);
  CHECK(rows[0]["scene.length_m"].is_number_float());
  CHECK(rows[1]["steps_done"].is_null());
  CHECK(rows[1]["outcome"] == "pending");
  CHECK(file.written(QueryOptions::Format::json, {"task"}, {}) == "[]\n");
}

TEST_CASE("a file whose columns have different lengths is called damaged") {
  const PartlyDone file;
  {
    const hdf5::File h5 = hdf5::open_file(file.path, H5F_ACC_RDWR);
    H5Ldelete(h5.id(), "/tasks/sample", H5P_DEFAULT);
    hdf5::create_dataset(h5.id(), "/tasks/sample", H5T_NATIVE_INT64, {2});
  }
  CHECK_THAT(message_of<FileError>([&] { TaskTable table(file.path); }), Contains("is damaged or incomplete"));
}
