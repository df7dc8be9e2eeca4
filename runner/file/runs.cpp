#include "runner/file/runs.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>
#include <variant>

namespace rodsweep {
namespace {

/// Which files have a column: all, or results files but not models.
enum class Files { all, results };

struct RunColumn {
  const char* path;
  std::variant<std::string Provenance::*, int Provenance::*, bool Provenance::*, std::string RunRow::*, int RunRow::*,
               double RunRow::*>
      member;
  std::int64_t text_bytes;  ///< 0: a number
  const char* meaning;
  Files files = Files::all;
  const char* unit = "1";
};

constexpr const char* begin_path = "/runs/begin";
constexpr std::array<RunColumn, 15> run_columns{{
    {begin_path, &Provenance::begin_utc, 24, "start of the run (UTC); empty: unused row"},
    {"/runs/end", &RunRow::end_utc, 24, "end of the run (UTC); empty: it still runs, or was killed"},
    {"/runs/host", &Provenance::host, 512, "hosts of its ranks"},
    {"/runs/command", &Provenance::user_command, 1024, "command line"},
    {"/runs/job", &Provenance::job, 1024, "path of the job file; relative paths in the job start at its folder"},
    {"/runs/revision", &Provenance::revision, 64, "git revision of the program"},
    {"/runs/versions", &Provenance::versions, 256, "program, libraries, compiler, vector instructions and processor"},
    {"/runs/petsc_options", &Provenance::petsc_options, 1024, "PETSC_OPTIONS of the environment"},
    {"/runs/source", &RunRow::source, 512,
     "file that this row was copied from (merge, --extend); empty: a run of this sweep", Files::results},
    {"/runs/ranks", &Provenance::ranks, 0, "MPI ranks"},
    {"/runs/shard", &Provenance::shard, 0, "number of the shard, from 1; 0: the whole sweep", Files::results},
    {"/runs/shards", &Provenance::shards, 0, "number of shards; 0: the whole sweep", Files::results},
    {"/runs/exit_code", &RunRow::exit_code, 0, "exit code of the program; -1: it still runs, or was killed"},
    {"/runs/left_s", &RunRow::left_s, 0,
     "time left at the last heartbeat of the run, by its own estimate; NaN: unknown", Files::results, "s"},
    {"/runs/oversubscribed", &Provenance::oversubscribed, 0, "1: more ranks than cores; times are not valid"},
}};

/// The type in the file of a RunRow's number.
template <class T>
using Stored = std::conditional_t<std::is_same_v<T, bool>, std::uint8_t, T>;

template <class Member>
auto& value_of(RunRow& run, Member member) {
  if constexpr (std::is_invocable_v<Member, RunRow&>)
    return run.*member;
  else
    return run.provenance.*member;
}

/// Calls on_text(std::string&) or on_number(T&) with the value of a column.
template <class OnText, class OnNumber>
void visit_value(const RunColumn& column, RunRow& run, OnText&& on_text, OnNumber&& on_number) {
  std::visit(
      [&](auto member) {
        auto& value = value_of(run, member);
        if constexpr (std::is_same_v<decltype(value), std::string&>)
          on_text(value);
        else
          on_number(value);
      },
      column.member);
}

void read_column(const RunColumn& column, const hdf5::RowDataset& rows, std::vector<RunRow>& runs) {
  for (std::size_t row = 0; row < runs.size(); ++row)
    visit_value(
        column, runs[row], [&](std::string& text) { text = rows.text(row); },
        [&](auto& number) {
          using T = std::decay_t<decltype(number)>;
          number = static_cast<T>(rows.number<Stored<T>>(row));
        });
}

}  // namespace

std::vector<Field> run_fields() {
  std::vector<Field> fields;
  RunRow any;
  for (const RunColumn& column : run_columns) {
    visit_value(
        column, any,
        [&](std::string&) { fields.push_back(text_field(column.path, column.text_bytes, {run_rows}, column.meaning)); },
        [&](auto& number) {
          using T = Stored<std::decay_t<decltype(number)>>;
          fields.push_back(number_field<T>(column.path, {run_rows}, column.unit, column.meaning));
        });
  }
  return fields;
}

std::vector<RunRow> read_runs(const hdf5::File& file) {
  const std::vector<std::string> begins = hdf5::read_all<std::string>(file.id(), begin_path);
  std::vector<RunRow> runs(static_cast<std::size_t>(std::find(begins.begin(), begins.end(), "") - begins.begin()));
  for (const RunColumn& column : run_columns)
    if (const hdf5::RowDataset rows(file.id(), column.path); rows) read_column(column, rows, runs);
  return runs;
}

void write_run(const hdf5::File& file, std::size_t row, const RunRow& run) {
  RunRow written = run;
  for (auto column = run_columns.rbegin(); column != run_columns.rend(); ++column) {
    const hdf5::RowDataset rows(file.id(), column->path);
    if (!rows) continue;
    visit_value(
        *column, written, [&](const std::string& text) { rows.put_text(row, text); },
        [&](auto number) { rows.put(row, static_cast<Stored<decltype(number)>>(number)); });
  }
}

void create_training_runs(hid_t file, std::vector<RunRow> runs) {
  for (const RunColumn& column : run_columns) {
    if (column.files == Files::results) continue;
    std::visit(
        [&](auto member) {
          std::vector<Stored<std::decay_t<decltype(value_of(std::declval<RunRow&>(), member))>>> values;
          for (RunRow& run : runs) values.push_back(value_of(run, member));
          if constexpr (std::is_same_v<decltype(values), std::vector<std::string>>)
            hdf5::store_texts(file, column.path, values);
          else
            hdf5::store(file, column.path, {runs.size()}, values, column.unit, column.meaning);
        },
        column.member);
  }
}

std::vector<RunRow> read_training_runs(hid_t file) {
  std::vector<RunRow> runs(hdf5::read_all<std::string>(file, begin_path).size());
  for (const RunColumn& column : run_columns) {
    if (column.files == Files::results) continue;
    const hdf5::RowDataset rows(file, column.path);
    if (!rows) throw Damage(std::string(column.path) + " is missing");
    read_column(column, rows, runs);
  }
  return runs;
}

}  // namespace rodsweep
