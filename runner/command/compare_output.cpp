#include "runner/command/compare_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "runner/file/task_table.hpp"
#include "runner/terminal/text.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::string>;

constexpr std::size_t most_keys = 20, most_changes = 10;

std::string number_text(double value, const char* format = "{:.4g}") {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

std::string interval_text(const Estimate& e) {
  return std::isnan(e.low) ? "-" : fmt::format("{:+.4g} to {:+.4g}", e.low, e.high);
}

/// Lines of cells under each other, the first of each to the left.
std::string table(const std::vector<Cells>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const Cells& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], characters(row[i]));
  std::string text;
  for (const Cells& row : rows) {
    text += ' ';
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string space(widths[i] - characters(row[i]), ' ');
      text += " " + (i == 0 ? row[i] + space : " " + space + row[i]);
    }
    text += '\n';
  }
  return text;
}

std::string revision(const FileSummary& file) { return file.runs.empty() ? "" : file.runs.back().provenance.revision; }

std::string hosts(const FileSummary& file) { return file.runs.empty() ? "" : file.runs.back().provenance.host; }

bool oversubscribed(const FileSummary& file) {
  return std::any_of(file.runs.begin(), file.runs.end(),
                     [](const RunRow& run) { return run.provenance.oversubscribed; });
}

std::string value_text(const Json& value) {
  if (value.is_null()) return "nothing";
  constexpr std::size_t longest = 60;
  const std::string text = value.dump();
  return text.size() <= longest ? text : text.substr(0, longest) + "...";
}

std::string heads_text(const ComparedFiles& files) {
  std::string text;
  for (const auto& [letter, file] : {std::pair("A", &files.a), std::pair("B", &files.b)})
    text += fmt::format("{}  {}: {}, {} of {} done, revision {}\n", letter, file->path.native(), file->job_name,
                        file->done, counted(file->tasks, "task"), revision(*file));
  return text;
}

std::string keys_text(const ComparedFiles& files) {
  if (files.keys.empty()) return "jobs: the same\n";
  std::string text = fmt::format("jobs: differ in {}\n", counted(static_cast<std::int64_t>(files.keys.size()), "key"));
  for (std::size_t i = 0; i < files.keys.size() && i < most_keys; ++i)
    text += fmt::format("  {}: {} in A, {} in B\n", files.keys[i].path, value_text(files.keys[i].a),
                        value_text(files.keys[i].b));
  if (files.keys.size() > most_keys) text += fmt::format("  and {} more: see --json\n", files.keys.size() - most_keys);
  return text;
}

bool changed(const TaskDifference& task) { return task.outcome_a != task.outcome_b; }

std::string task_text(const TaskDifference& task) {
  std::string text = fmt::format("  task {} (of B {}):", task.a, task.b);
  if (changed(task)) text += fmt::format(" {} in A, {} in B;", task.outcome_a, task.outcome_b);
  return fmt::format("{} {}\n", text,
                     task.columns.empty() ? "no value differs" : fmt::format("{}", fmt::join(task.columns, " ")));
}

/// "not recorded in both, or at other lengths: /solves (12 columns)"
std::string left_out_text(const std::vector<std::string>& paths) {
  std::map<std::string, int> groups;
  for (const std::string& path : paths) ++groups[path.substr(0, path.find('/', 1))];
  std::string text;
  for (const auto& [group, count] : groups)
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", group, counted(count, "column"));
  return fmt::format("not compared, since it is not in both or of another length: {}\n", text);
}

std::string results_text(const ComparedFiles& files) {
  const SweepComparison& found = files.found;
  const auto differing = static_cast<std::int64_t>(found.differing.size());
  std::string text =
      fmt::format("tasks: {} in both, {} in A alone, {} in B alone\n", files.both, files.only_a, files.only_b);
  text += fmt::format("results: {} compared{}, {} the same to the last bit, {} differ{}\n", found.compared,
                      found.pending > 0 ? fmt::format(" ({} more not done in both)", found.pending) : "",
                      found.compared - differing, differing, differing == 1 ? "s" : "");
  if (!found.columns.empty()) {
    std::vector<Cells> rows{{"column", "tasks", "values", "largest difference", "in task"}};
    for (const ColumnDifference& column : found.columns)
      rows.push_back({column.path, fmt::format("{}", column.tasks), fmt::format("{}", column.values),
                      std::isinf(column.largest) ? "one is missing" : number_text(column.largest, "{:.3g}"),
                      fmt::format("{}", column.task)});
    text += table(rows);
  }
  if (!found.left_out.empty()) text += left_out_text(found.left_out);
  return text;
}

std::string outcomes_text(const SweepComparison& found) {
  const auto count = std::count_if(found.differing.begin(), found.differing.end(), changed);
  if (count == 0) return "";
  std::string text = fmt::format("outcomes: {} changed\n", count);
  std::size_t shown = 0;
  for (const TaskDifference& task : found.differing)
    if (changed(task) && ++shown <= most_changes)
      text += fmt::format("  task {} (of B {}): {} in A, {} in B\n", task.a, task.b, task.outcome_a, task.outcome_b);
  if (shown > most_changes) text += fmt::format("  and {} more: see --tasks\n", shown - most_changes);
  return text;
}

std::string ratios_text(const ComparedFiles& files) {
  std::vector<Cells> rows{{"guess", "A", "B", "B - A", "95 %", "tasks"}};
  for (const RatioComparison& row : files.found.ratios)
    if (row.tolerance == files.headline)
      rows.push_back({row.guess, number_text(row.a.value), number_text(row.b.value),
                      number_text(row.difference.value, "{:+.4g}"), interval_text(row.difference),
                      fmt::format("{}", row.difference.count)});
  if (rows.size() == 1) return "";
  return fmt::format("CG ratio at {}, mean of tasks that are ok in both\n", tolerance_text(files.headline)) +
         table(rows);
}

std::string times_text(const ComparedFiles& files) {
  if (files.found.times.empty()) return "";
  std::string remark;
  if (hosts(files.a) != hosts(files.b))
    remark = fmt::format("; other machines: {} and {}", hosts(files.a), hosts(files.b));
  if (oversubscribed(files.a) || oversubscribed(files.b)) remark += "; more ranks than cores: worthless";
  std::vector<Cells> rows{{"time", "A", "B", "B / A", "tasks"}};
  for (const TimeComparison& time : files.found.times)
    rows.push_back({time.what, short_duration_text(time.a_s), short_duration_text(time.b_s),
                    number_text(time.ratio, "{:.3g}"), fmt::format("{}", time.tasks)});
  return fmt::format("times, medians{}\n", remark) + table(rows);
}

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json json_of(const FileSummary& file) {
  return {{"file", file.path.native()},
          {"job", file.job_name},
          {"revision", revision(file)},
          {"tasks", file.tasks},
          {"done", file.done},
          {"hosts", hosts(file)},
          {"oversubscribed", oversubscribed(file)}};
}

std::string csv_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace

std::string comparison_text(const ComparedFiles& files, bool tasks) {
  std::string text = heads_text(files) + keys_text(files) + results_text(files) + outcomes_text(files.found) +
                     ratios_text(files) + times_text(files);
  if (tasks && !files.found.differing.empty()) {
    text += "tasks that differ\n";
    for (const TaskDifference& task : files.found.differing) text += task_text(task);
  }
  return text;
}

std::string comparison_csv(const ComparedFiles& files, bool tasks) {
  std::string text;
  if (tasks) {
    text = "task_a,task_b,outcome_a,outcome_b,columns\n";
    for (const TaskDifference& task : files.found.differing)
      text +=
          fmt::format("{},{},{},{},{}\n", task.a, task.b, task.outcome_a, task.outcome_b, fmt::join(task.columns, " "));
    return text;
  }
  text = "guess,tolerance,ratio_a,ratio_b,difference,low,high,tasks\n";
  for (const RatioComparison& row : files.found.ratios)
    text += fmt::format("{},{},{},{},{},{},{},{}\n", csv_text(row.guess), row.tolerance, csv_number(row.a.value),
                        csv_number(row.b.value), csv_number(row.difference.value), csv_number(row.difference.low),
                        csv_number(row.difference.high), row.difference.count);
  return text;
}

std::string comparison_json(const ComparedFiles& files) {
  const SweepComparison& found = files.found;
  Json json{{"a", json_of(files.a)},
            {"b", json_of(files.b)},
            {"matched_by", files.by == MatchBy::everything ? "everything" : "parameters"},
            {"keys", Json::array()},
            {"tasks",
             {{"both", files.both},
              {"only_a", files.only_a},
              {"only_b", files.only_b},
              {"pending", found.pending},
              {"damaged", found.damaged.size()},
              {"compared", found.compared},
              {"differing", found.differing.size()}}},
            {"columns", Json::array()},
            {"left_out", found.left_out},
            {"differing", Json::array()},
            {"cg_ratio", Json::array()},
            {"times", Json::array()},
            {"same_hosts", hosts(files.a) == hosts(files.b)}};
  for (const KeyDifference& key : files.keys) json["keys"].push_back({{"key", key.path}, {"a", key.a}, {"b", key.b}});
  for (const ColumnDifference& column : found.columns)
    json["columns"].push_back({{"column", column.path},
                               {"tasks", column.tasks},
                               {"values", column.values},
                               {"largest", json_number(column.largest)},
                               {"task", column.task}});
  for (const TaskDifference& task : found.differing)
    json["differing"].push_back({{"a", task.a},
                                 {"b", task.b},
                                 {"outcome_a", task.outcome_a},
                                 {"outcome_b", task.outcome_b},
                                 {"columns", task.columns}});
  for (const RatioComparison& row : found.ratios)
    json["cg_ratio"].push_back({{"guess", row.guess},
                                {"tolerance", row.tolerance},
                                {"a", json_number(row.a.value)},
                                {"b", json_number(row.b.value)},
                                {"difference", json_number(row.difference.value)},
                                {"low", json_number(row.difference.low)},
                                {"high", json_number(row.difference.high)},
                                {"tasks", row.difference.count}});
  for (const TimeComparison& time : found.times)
    json["times"].push_back({{"what", time.what},
                             {"a_s", json_number(time.a_s)},
                             {"b_s", json_number(time.b_s)},
                             {"ratio", json_number(time.ratio)},
                             {"tasks", time.tasks}});
  return json.dump(2);
}

}  // namespace rodsweep
