#include "runner/file/layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "runner/file/columns.hpp"
#include "runner/file/runs.hpp"
#include "runner/text/checksum.hpp"

namespace rodsweep {
namespace {

std::int64_t longest(const std::vector<std::string>& texts) {
  std::size_t bytes = 1;
  for (const std::string& text : texts) bytes = std::max(bytes, text.size());
  return static_cast<std::int64_t>(bytes);
}

void append_parameters(std::vector<Field>& fields, const Plan& plan, const std::vector<ParameterColumn>& parameters) {
  for (const ParameterColumn& parameter : parameters) {
    const std::string path = "/tasks/parameters/" + parameter.path;
    const std::string unit = parameter.unit.empty() ? "1" : parameter.unit;
    std::vector<std::int64_t> extent{plan.size()};
    if (parameter.width > 1) extent.push_back(parameter.width);
    const auto append = [&](const auto& values) {
      using Value = typename std::decay_t<decltype(values)>::value_type;
      if constexpr (std::is_same_v<Value, std::string>)
        fields.push_back(text_field(path, longest(values.distinct()), extent, parameter.meaning));
      else
        fields.push_back(number_field<Value>(path, extent, unit, parameter.meaning));
    };
    std::visit(append, parameter.values);
  }
}

/// Throws FileError for sizes beyond any file system, far below overflow.
void check_sizes(const std::vector<Field>& fields, const Plan& plan) {
  constexpr double most_bytes = 1e18;
  double all = 0;
  for (const Field& field : fields) {
    const auto element = static_cast<std::int64_t>(H5Tget_size(type_of(field).id()));
    all += std::accumulate(field.extent.begin(), field.extent.end(), static_cast<double>(element), std::multiplies<>());
    if (all <= most_bytes) continue;
    throw FileError(
        "{}: the results file would be too large: {} has {} values of {} bytes, and the file exceeds {} bytes; record "
        "less (record.solves: \"summary\", record.systems: \"first\", a larger record.trajectory_every), or split the "
        "job",
        plan.job().path.native(), field.path, fmt::join(field.extent, " x "), element, most_bytes);
  }
}

}  // namespace

std::vector<Field> layout(const Plan& plan, const std::vector<ParameterColumn>& parameters) {
  std::vector<Field> fields;
  const AxisSizes sizes = axis_sizes(plan);
  fields.push_back(text_field("/job/text", std::max<std::int64_t>(1, static_cast<std::int64_t>(plan.job().text.size())),
                              {}, "the job file, byte for byte"));
  for (Field& field : run_fields()) fields.push_back(std::move(field));
  fields.push_back(text_field("/axes/guess", longest(plan.guess_labels()), {sizes.guesses},
                              "initial guesses, in the order of the guess axes; parameters of guess i that vary are in "
                              "/tasks/parameters/guesses[i]..."));
  fields.push_back(number_field<double>("/axes/tolerance", {sizes.tolerances}, "1",
                                        "tolerances at which iterations are counted, relative to ||b||"));
  append_parameters(fields, plan, parameters);
  const auto holds = [&](const RowPlace& place) { return plan.rows(place.with) > 0; };
  visit_planned_columns(holds, [&](const char* path, const char* meaning, auto member) {
    using Value = std::decay_t<decltype(member(std::declval<const Task&>()))>;
    fields.push_back(number_field<Value>(path, {plan.size()}, "1", meaning));
  });
  fields.push_back(number_field<std::uint8_t>("/tasks/state", {plan.size()}, "1",
                                              "1: complete, all of its rows are valid; 0: pending, ignore its rows"));
  fields.push_back(text_field("/tasks/outcome", outcome_bytes, {plan.size()}, "how the task ended"));
  fields.push_back(
      text_field("/tasks/message", message_bytes, {plan.size()}, "why the outcome is not ok, or a warning"));
  fields.push_back(number_field<std::uint64_t>("/tasks/checksum", {plan.size()}, "1",
                                               "checksum of all data of the task outside /timing"));
  for (const Column& column : columns()) {
    std::vector<std::int64_t> extent = row_extent(column, sizes);
    extent.insert(extent.begin(), plan.rows(column.rows));
    fields.push_back({column.path, column.type, 0, std::move(extent), column.unit, column.meaning});
  }
  fields.push_back(
      number_field<double>("/timing/tasks/write_s", {plan.size()}, "s", "wall time of writing its results"));
  fields.push_back(number_field<std::int32_t>("/timing/tasks/rank", {plan.size()}, "1", "MPI rank that ran it"));
  fields.push_back(text_field("/timing/tasks/host", host_bytes, {plan.size()}, "host of that rank"));
  fields.push_back(
      number_field<std::int32_t>("/timing/tasks/run", {plan.size()}, "1", "row in /runs of the run that computed it"));
  fields.push_back(
      number_field<std::uint8_t>("/timing/tasks/tries", {plan.size()}, "1",
                                 "tries without a result: the worker crashed, hung or still runs the task"));
  check_sizes(fields, plan);
  fields.erase(std::remove_if(fields.begin(), fields.end(), [](const Field& field) { return data_bytes(field) == 0; }),
               fields.end());
  return fields;
}

Field text_field(std::string path, std::int64_t bytes, std::vector<std::int64_t> extent, std::string meaning) {
  return {std::move(path), nullptr, bytes, std::move(extent), "1", std::move(meaning)};
}

hdf5::Datatype type_of(const Field& field) {
  if (field.number == nullptr) return hdf5::text_type(static_cast<std::size_t>(field.text_bytes));
  return hdf5::Datatype(hdf5::check(H5Tcopy(field.number()), "H5Tcopy"));
}

std::int64_t data_bytes(const Field& field) {
  const auto element = static_cast<std::int64_t>(H5Tget_size(type_of(field).id()));
  return std::accumulate(field.extent.begin(), field.extent.end(), element, std::multiplies<>());
}

std::string plan_hash(const Plan& plan, const std::vector<ParameterColumn>& parameters) {
  Checksum sum;
  const auto add_text = [&](const std::string& text) { sum.add(text.data(), text.size()); };
  visit_planned_values(plan, [&](const char* path, const char*, const auto& values) {
    add_text(path);
    for (const auto& value : values) sum.add(&value, sizeof value);
  });
  for (const ParameterColumn& parameter : parameters) {
    add_text(parameter.path);
    if (const auto* texts = std::get_if<ColumnValues<std::string>>(&parameter.values)) {
      for (const std::string& text : texts->all()) add_text(text);
    } else if (const auto* integers = std::get_if<ColumnValues<std::int64_t>>(&parameter.values)) {
      const std::vector<std::int64_t> all = integers->all();
      sum.add(all.data(), all.size() * sizeof(std::int64_t));
    }
  }
  for (const std::string& label : plan.guess_labels()) add_text(label);
  for (const auto& [text, file] : plan.job().files) add_text(text + " " + file.hash);
  for (const double tolerance : tolerance_ladder()) sum.add(&tolerance, sizeof tolerance);
  return fmt::format("{:016x}", sum.value());
}

}  // namespace rodsweep
