#include "runner/command/query_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "runner/terminal/text.hpp"

namespace rodsweep {
namespace {

constexpr std::size_t piece_bytes = 1 << 16;

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

std::string table_cell(const ShownColumn& shown, std::size_t task) {
  if (!shown.column.is_number()) {
    const std::string& text = shown.values->texts[task];
    return text.empty() ? "-" : one_line(text);
  }
  const double number = shown.values->numbers[task];
  if (std::isnan(number)) return "-";
  return shown.column.whole ? fmt::format("{:.0f}", number) : fmt::format("{:.6g}", number);
}

std::string csv_cell(const ShownColumn& shown, std::size_t task) {
  if (!shown.column.is_number()) return csv_text(shown.values->texts[task]);
  const double number = shown.values->numbers[task];
  return std::isnan(number) ? "" : shown.column.whole ? fmt::format("{:.0f}", number) : fmt::format("{}", number);
}

nlohmann::ordered_json json_cell(const ShownColumn& shown, std::size_t task) {
  if (!shown.column.is_number()) {
    const std::string& text = shown.values->texts[task];
    return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
  }
  const double number = shown.values->numbers[task];
  if (!std::isfinite(number)) return {};
  return shown.column.whole ? nlohmann::ordered_json(static_cast<std::int64_t>(number))
                            : nlohmann::ordered_json(number);
}

using Cells = std::vector<std::string>;

std::string table_line(const std::vector<ShownColumn>& columns, const std::vector<std::size_t>& widths,
                       const Cells& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string space(widths[i] - characters(cells[i]), ' ');
    line += (i > 0 ? "  " : "") + (columns[i].column.is_number() ? space + cells[i] : cells[i] + space);
  }
  return line.erase(line.find_last_not_of(' ') + 1) + '\n';
}

}  // namespace

void write_tasks(QueryOptions::Format format, const std::vector<ShownColumn>& columns,
                 const std::vector<std::int64_t>& tasks, const std::function<void(std::string_view)>& write) {
  std::string piece;
  const auto put = [&](const std::string& text) {
    piece += text;
    if (piece.size() < piece_bytes) return;
    write(piece);
    piece.clear();
  };
  Cells names;
  for (const ShownColumn& shown : columns) names.push_back(shown.column.name);

  if (format == QueryOptions::Format::table) {
    std::vector<std::size_t> widths;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      widths.push_back(characters(names[i]));
      for (const std::int64_t task : tasks)
        widths[i] = std::max(widths[i], characters(table_cell(columns[i], static_cast<std::size_t>(task))));
    }
    put(table_line(columns, widths, names));
    for (const std::int64_t task : tasks) {
      Cells cells;
      for (const ShownColumn& shown : columns) cells.push_back(table_cell(shown, static_cast<std::size_t>(task)));
      put(table_line(columns, widths, cells));
    }
  } else if (format == QueryOptions::Format::csv) {
    for (std::size_t i = 0; i < names.size(); ++i) put((i > 0 ? "," : "") + csv_text(names[i]));
    put("\n");
    for (const std::int64_t task : tasks) {
      for (std::size_t i = 0; i < columns.size(); ++i)
        put((i > 0 ? "," : "") + csv_cell(columns[i], static_cast<std::size_t>(task)));
      put("\n");
    }
  } else {
    const char* before = "[\n";
    for (const std::int64_t task : tasks) {
      nlohmann::ordered_json row;
      for (const ShownColumn& shown : columns)
        row[shown.column.name] = json_cell(shown, static_cast<std::size_t>(task));
      put(before + row.dump());
      before = ",\n";
    }
    put(tasks.empty() ? "[]\n" : "\n]\n");
  }
  write(piece);
}

}  // namespace rodsweep
