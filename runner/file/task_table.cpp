#include "runner/file/task_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "runner/file/file_reading.hpp"
#include "runner/file/planned_columns.hpp"
#include "runner/job/nearest.hpp"

namespace rodsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr hsize_t block_values = 1 << 16;
constexpr double same_tolerance = 1e-6;

bool same(double a, double b) { return std::abs(a - b) <= same_tolerance * b; }

std::vector<std::string> members(hid_t file, const std::string& group) {
  if (!hdf5::exists(file, group)) return {};
  return hdf5::members(hdf5::Object(hdf5::check(H5Oopen(file, group.c_str(), H5P_DEFAULT), "H5Oopen", group)).id());
}

bool is_dataset(hid_t file, const std::string& path) {
  const hdf5::Object object(hdf5::check(H5Oopen(file, path.c_str(), H5P_DEFAULT), "H5Oopen", path));
  return H5Iget_type(object.id()) == H5I_DATASET;
}

std::string attribute(hid_t file, const std::string& path, const char* name) {
  return hdf5::has_attribute(file, path, name) ? hdf5::read_text_attribute(file, path, name) : "";
}

/// Known before the task runs.
bool is_planned(const std::string& path) {
  bool found = false;
  visit_planned_columns([](const RowPlace&) { return true; },
                        [&](const char* planned, const char*, auto) { found = found || path == planned; });
  return found;
}

TaskColumn own_column(const char* name, TaskColumn::Kind kind, const char* meaning) {
  TaskColumn column;
  column.name = name;
  column.kind = kind;
  column.whole = kind == TaskColumn::Kind::task;
  column.meaning = meaning;
  return column;
}

}  // namespace

std::string tolerance_text(double tolerance) {
  const double exponent = std::round(std::log10(tolerance));
  return same(tolerance, std::pow(10, exponent)) ? fmt::format("1e{:.0f}", exponent) : fmt::format("{:g}", tolerance);
}

TaskTable::TaskTable(const std::filesystem::path& path) : path_(path), file_(open_results(path)) {
  try {
    states_ = read_states(file_, path);
    if (hdf5::exists(file_.id(), "/axes/guess")) guesses_ = hdf5::read_texts(file_.id(), "/axes/guess");
    tolerances_ = hdf5::read_all<double>(file_.id(), "/axes/tolerance");
    choose_headline();
    columns_ = {own_column("task", TaskColumn::Kind::task, "number of the task: its row in /tasks"),
                own_column("state", TaskColumn::Kind::state, "\"done\" or \"pending\"")};
    list("/tasks", false);
    list("/tasks/parameters", true);
    list("/timing/tasks", false);
  } catch (const FileError&) {
    throw;
  } catch (const std::exception& failure) {
    throw damaged_error(path, damage_text(failure));
  }
}

double TaskTable::headline() const { return tolerances_.at(headline_); }

void TaskTable::choose_headline() {
  double wanted = 1e-2;
  const std::string path = "/tasks/parameters/solve.tolerance";
  if (hdf5::exists(file_.id(), path)) {
    const auto used = hdf5::read_all<double>(file_.id(), path);
    const bool one = std::all_of(used.begin(), used.end(), [&](double value) { return value == used.front(); });
    const auto is_used = [&](double tolerance) { return same(tolerance, used.front()); };
    if (one && !used.empty() && std::any_of(tolerances_.begin(), tolerances_.end(), is_used)) wanted = used.front();
  }
  for (std::size_t t = 0; t < tolerances_.size(); ++t)
    if (same(tolerances_[t], wanted)) headline_ = t;
}

void TaskTable::list(const char* group, bool parameters) {
  for (const std::string& name : members(file_.id(), group)) {
    const std::string path = std::string(group) + "/" + name;
    if (path == "/tasks/state" || path == "/tasks/checksum" || !is_dataset(file_.id(), path)) continue;
    add(name, path, parameters);
  }
}

void TaskTable::add(const std::string& name, const std::string& path, bool parameter) {
  const hdf5::RowDataset rows(file_.id(), path);
  if (rows.rows() != states_.size()) throw Damage(path + " has another length than /tasks/state");
  const H5T_class_t type = H5Tget_class(rows.type().id());
  TaskColumn column;
  column.name = name;
  column.path = path;
  column.unit = attribute(file_.id(), path, "unit");
  if (column.unit == "1") column.unit.clear();
  column.meaning = attribute(file_.id(), path, "meaning");
  column.kind = type == H5T_STRING ? TaskColumn::Kind::text : TaskColumn::Kind::number;
  column.whole = type == H5T_INTEGER;
  column.parameter = parameter;
  column.swept =
      hdf5::has_attribute(file_.id(), path, "swept") && hdf5::read_int_attribute(file_.id(), path, "swept") != 0;
  column.result = !parameter && !is_planned(path);
  if (path == "/tasks/outcome") column.kind = TaskColumn::Kind::outcome;
  if (path == "/tasks/own_guess") {
    column.kind = TaskColumn::Kind::own_guess;
    column.meaning = "the guess that advances the rods; none: the direct solve does";
    const auto own = hdf5::read_all<std::int32_t>(file_.id(), path);
    own_guesses_ = std::any_of(own.begin(), own.end(), [](std::int32_t guess) { return guess >= 0; });
  }

  const std::size_t width = rows.row_values(), g = guesses_.size(), t = tolerances_.size();
  if (width == 1) {
    columns_.push_back(column);
  } else if (parameter && width == 3) {
    for (std::size_t i = 0; i < width; ++i) {
      columns_.push_back(column);
      columns_.back().name += std::string(".") + "xyz"[i];
      columns_.back().element = i;
    }
  } else if (g > 0 && (width == g || width == g * t)) {
    column.by_tolerance = width != g;
    for (std::size_t i = 0; i < g; ++i) {
      columns_.push_back(column);
      columns_.back().name += "." + guesses_[i];
      columns_.back().guess = guesses_[i];
      columns_.back().element = column.by_tolerance ? i * t + headline_ : i;
    }
  }
}

std::optional<TaskColumn> TaskTable::find(const std::string& name) const {
  const auto listed = [&](const std::string& wanted) {
    return std::find_if(columns_.begin(), columns_.end(), [&](const TaskColumn& c) { return c.name == wanted; });
  };
  if (const auto found = listed(name); found != columns_.end()) return *found;
  const std::size_t at = name.rfind('@');
  const auto found = at == std::string::npos ? columns_.end() : listed(name.substr(0, at));
  if (found == columns_.end() || !found->by_tolerance) return std::nullopt;
  const double wanted = std::strtod(name.c_str() + at + 1, nullptr);
  for (std::size_t t = 0; t < tolerances_.size(); ++t) {
    if (!same(tolerances_[t], wanted)) continue;
    TaskColumn column = *found;
    column.name = found->name + "@" + tolerance_text(tolerances_[t]);
    column.element = found->element - headline_ + t;
    return column;
  }
  return std::nullopt;
}

TaskColumn TaskTable::column(const std::string& name) const {
  if (const auto found = find(name)) return *found;
  std::vector<std::string> names;
  for (const TaskColumn& column : columns_) {
    names.push_back(column.name);
    if (!column.by_tolerance || name.rfind(column.name + "@", 0) != 0) continue;
    std::string known;
    for (const double tolerance : tolerances_) known += (known.empty() ? "" : ", ") + tolerance_text(tolerance);
    throw FileError(fmt::format("{} has no column \"{}\"; its tolerances are {}", path_.native(), name, known));
  }
  throw FileError(fmt::format("{} has no column \"{}\"{} (--columns help lists them all)", path_.native(), name,
                              did_you_mean(name, names)));
}

std::vector<double> TaskTable::numbers(const TaskColumn& column) const {
  const hdf5::RowDataset rows(file_.id(), column.path);
  const hsize_t width = rows.row_values(), block = std::max<hsize_t>(1, block_values / width);
  std::vector<double> values(states_.size()), buffer;
  for (hsize_t first = 0; first < values.size(); first += block) {
    const hsize_t count = std::min<hsize_t>(block, values.size() - first);
    buffer.resize(count * width);
    rows.read(hdf5::type_of<double>(), first, count, buffer.data());
    for (hsize_t i = 0; i < count; ++i) {
      const double value = buffer[i * width + column.element];
      values[first + i] = column.whole && value < 0 ? nan : value;
    }
  }
  return values;
}

ColumnValues TaskTable::read(const TaskColumn& column) const {
  ColumnValues values;
  try {
    switch (column.kind) {
      case TaskColumn::Kind::task:
        for (std::int64_t task = 0; task < size(); ++task) values.numbers.push_back(static_cast<double>(task));
        break;
      case TaskColumn::Kind::state:
        for (const std::uint8_t state : states_) values.texts.emplace_back(state == 1 ? "done" : "pending");
        break;
      case TaskColumn::Kind::own_guess:
        for (const double guess : numbers(column))
          values.texts.push_back(guess >= 0 ? guesses_.at(static_cast<std::size_t>(guess)) : "");
        break;
      case TaskColumn::Kind::number: values.numbers = numbers(column); break;
      case TaskColumn::Kind::outcome:
      case TaskColumn::Kind::text: values.texts = hdf5::read_texts(file_.id(), column.path); break;
    }
  } catch (const std::exception& failure) {
    throw damaged_error(path_, damage_text(failure));
  }
  if (!column.result) return values;
  for (std::size_t task = 0; task < states_.size(); ++task) {
    if (states_[task] == 1) continue;
    if (column.is_number()) values.numbers[task] = nan;
    if (!column.is_number()) values.texts[task] = column.kind == TaskColumn::Kind::outcome ? "pending" : "";
  }
  return values;
}

}  // namespace rodsweep
