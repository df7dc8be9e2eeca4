#include "runner/file/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "runner/file/planned_columns.hpp"
#include "runner/job/checksum.hpp"

namespace rodsweep {
namespace {

std::int64_t longest(const std::vector<std::string>& texts) {
  std::size_t bytes = 1;
  for (const std::string& text : texts) bytes = std::max(bytes, text.size());
  return static_cast<std::int64_t>(bytes);
}

Field text_field(std::string path, std::int64_t bytes, std::vector<std::int64_t> extent, std::string meaning) {
  return {std::move(path), Element::text, bytes, std::move(extent), "1", std::move(meaning)};
}

template <class T>
Field number_field(std::string path, std::vector<std::int64_t> extent, std::string unit, std::string meaning) {
  return {std::move(path), element_of<T>(), 0, std::move(extent), std::move(unit), std::move(meaning)};
}

void append_runs(std::vector<Field>& fields) {
  const auto text = [&](const char* name, std::int64_t bytes, const char* meaning) {
    fields.push_back(text_field(std::string("/runs/") + name, bytes, {run_rows}, meaning));
  };
  text("begin", 24, "when this start of the sweep began (UTC); empty: an unused row");
  text("end", 24, "when it ended (UTC); empty: it still runs, or was killed");
  text("host", 512, "hosts of its ranks");
  text("command", 1024, "command line");
  text("job", 1024, "path of the job file; relative paths in the job begin in its folder");
  text("revision", 64, "git revision of the program");
  text("versions", 256, "program, libraries and compiler");
  text("petsc_options", 1024, "PETSC_OPTIONS of the environment");
  text("source", 512,
       "the file that this sweep extends and that this row was copied from; empty: a start of this sweep");
  fields.push_back(number_field<std::int32_t>("/runs/ranks", {run_rows}, "1", "MPI ranks"));
  fields.push_back(number_field<std::int32_t>("/runs/exit_code", {run_rows}, "1",
                                              "exit code of the program; -1: it still runs, or was killed"));
  fields.push_back(number_field<std::uint8_t>("/runs/oversubscribed", {run_rows}, "1",
                                              "1: more ranks than cores, so that its times are worthless"));
}

void append_parameters(std::vector<Field>& fields, const Plan& plan, const std::vector<ParameterColumn>& parameters) {
  for (const ParameterColumn& parameter : parameters) {
    const std::string path = "/tasks/parameters/" + parameter.path;
    const std::string unit = parameter.unit.empty() ? "1" : parameter.unit;
    std::vector<std::int64_t> extent{plan.size()};
    if (parameter.width > 1) extent.push_back(parameter.width);
    if (const auto* texts = std::get_if<std::vector<std::string>>(&parameter.values)) {
      fields.push_back(text_field(path, longest(*texts), extent, parameter.meaning));
    } else if (std::holds_alternative<std::vector<std::int64_t>>(parameter.values)) {
      fields.push_back(number_field<std::int64_t>(path, extent, unit, parameter.meaning));
    } else {
      fields.push_back(number_field<double>(path, extent, unit, parameter.meaning));
    }
  }
}

}  // namespace

std::vector<Field> layout(const Plan& plan, const std::vector<ParameterColumn>& parameters) {
  std::vector<Field> fields;
  const AxisSizes sizes = axis_sizes(plan);
  fields.push_back(text_field("/job/text", std::max<std::int64_t>(1, static_cast<std::int64_t>(plan.job().text.size())),
                              {}, "the job file, byte for byte"));
  append_runs(fields);
  fields.push_back(
      text_field("/axes/guess", longest(plan.guess_labels()), {sizes.guesses},
                 "initial guesses, in the order of the guess axes; what varies of guess i over the tasks is in "
                 "/tasks/parameters/guesses[i]..."));
  fields.push_back(number_field<double>("/axes/tolerance", {sizes.tolerances}, "1",
                                        "tolerances at which iterations are counted, relative to ||b||"));
  append_parameters(fields, plan, parameters);
  visit_planned_values(plan, [&](const char* path, const char* meaning, const auto& values) {
    fields.push_back(
        number_field<typename std::decay_t<decltype(values)>::value_type>(path, {plan.size()}, "1", meaning));
  });
  fields.push_back(number_field<std::uint8_t>("/tasks/state", {plan.size()}, "1",
                                              "1: complete, all of its rows are valid; 0: pending, ignore its rows"));
  fields.push_back(text_field("/tasks/outcome", outcome_bytes, {plan.size()}, "how the task ended"));
  fields.push_back(
      text_field("/tasks/message", message_bytes, {plan.size()}, "what happened where the outcome is not ok"));
  fields.push_back(number_field<std::uint64_t>("/tasks/checksum", {plan.size()}, "1",
                                               "over everything that the task wrote outside /timing"));
  const TaskRecord record;
  visit_columns(record, [&](const Column& column, const auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    std::vector<std::int64_t> extent{plan.rows(column.rows)};
    for (const Axis axis : column.axes) extent.push_back(sizes.size(axis));
    fields.push_back(number_field<T>(column.path, std::move(extent), column.unit, column.meaning));
  });
  fields.push_back(
      number_field<double>("/timing/tasks/write_s", {plan.size()}, "s", "wall time of writing its results"));
  fields.push_back(number_field<std::int32_t>("/timing/tasks/rank", {plan.size()}, "1", "MPI rank that ran it"));
  fields.push_back(text_field("/timing/tasks/host", host_bytes, {plan.size()}, "host of that rank"));
  fields.push_back(
      number_field<std::int32_t>("/timing/tasks/attempt", {plan.size()}, "1", "row of /runs in which it ran"));
  fields.erase(std::remove_if(fields.begin(), fields.end(), [](const Field& field) { return data_bytes(field) == 0; }),
               fields.end());
  return fields;
}

hdf5::Datatype type_of(const Field& field) {
  const auto copy = [](hid_t type) { return hdf5::Datatype(hdf5::check(H5Tcopy(type), "H5Tcopy")); };
  switch (field.element) {
    case Element::int8: return copy(H5T_NATIVE_INT8);
    case Element::uint8: return copy(H5T_NATIVE_UINT8);
    case Element::int16: return copy(H5T_NATIVE_INT16);
    case Element::int32: return copy(H5T_NATIVE_INT32);
    case Element::int64: return copy(H5T_NATIVE_INT64);
    case Element::uint64: return copy(H5T_NATIVE_UINT64);
    case Element::float32: return copy(H5T_NATIVE_FLOAT);
    case Element::float64: return copy(H5T_NATIVE_DOUBLE);
    case Element::text: break;
  }
  return hdf5::text_type(static_cast<std::size_t>(field.text_bytes));
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
    if (const auto* texts = std::get_if<std::vector<std::string>>(&parameter.values)) {
      for (const std::string& text : *texts) add_text(text);
    } else if (const auto* numbers = std::get_if<std::vector<std::int64_t>>(&parameter.values)) {
      sum.add(numbers->data(), numbers->size() * sizeof(std::int64_t));
    }
  }
  for (const std::string& label : plan.guess_labels()) add_text(label);
  for (const auto& [text, file] : plan.job().files) add_text(text + " " + file.hash);
  for (const double tolerance : tolerance_ladder()) sum.add(&tolerance, sizeof tolerance);
  return fmt::format("{:016x}", sum.value());
}

}  // namespace rodsweep
