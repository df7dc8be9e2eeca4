#include "runner/file/sweep_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <set>
#include <string_view>
#include <type_traits>

#include "runner/file/columns.hpp"
#include "runner/file/task_reader.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What of a column differs in a task: how many values, and the largest difference.
struct Found {
  std::int64_t values = 0;
  double largest = 0;
};

template <class Value>
void compare_values(const Value* a, const Value* b, std::size_t count, Found& found) {
  for (std::size_t i = 0; i < count; ++i) {
    if (std::memcmp(a + i, b + i, sizeof(Value)) == 0) continue;
    const auto x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
    if (std::isnan(x) && std::isnan(y)) continue;
    ++found.values;
    found.largest = std::max(found.largest, std::isnan(x) || std::isnan(y) ? INFINITY : std::abs(y - x));
  }
}

/// Does it say where frames of this file are, or how many of them its longest task has?
bool is_place(const Column& column) {
  return std::string_view(column.path).rfind("/trajectories/", 0) == 0 && column.rows == Rows::task;
}

/// A task of one of the files.
struct Read {
  Task task;
  TaskRecord record;
};

/// Values of a row that are of one guess.
std::size_t guess_block(const Column& column, const AxisSizes& sizes) {
  return column.axes.size() > 1 ? static_cast<std::size_t>(sizes.tolerances) : 1;
}

class Comparison {
 public:
  Comparison(const fs::path& a, const Plan& plan_a, const fs::path& b, const Plan& plan_b)
      : a_(a),
        b_(b),
        sizes_a_(axis_sizes(plan_a)),
        sizes_b_(axis_sizes(plan_b)),
        plan_a_(&plan_a),
        same_frames_(frames_every(plan_a) == frames_every(plan_b)),
        found_(columns().size()) {}

  void add(const TaskPair& pair) {
    if (!a_.done(pair.a) || !b_.done(pair.b)) {
      ++result_.pending;
      return;
    }
    Read a{a_.tasks()[static_cast<std::size_t>(pair.a)], {}}, b{b_.tasks()[static_cast<std::size_t>(pair.b)], {}};
    const bool whole_a = a_.read_intact(pair.a, a.record), whole_b = b_.read_intact(pair.b, b.record);
    if (!whole_a || !whole_b) {
      result_.damaged.push_back(pair);
      return;
    }
    ++result_.compared;
    compare(pair, a, b);
    if (a.record.outcome != TaskOutcome::ok || b.record.outcome != TaskOutcome::ok) return;
    draws_.push_back(a.task.sample);
    add_ratios(pair, a.record, b.record);
    add_times(pair, a.record, b.record);
  }

  SweepComparison finish();

 private:
  static std::int64_t frames_every(const Plan& plan) { return plan.job().values["record"]["trajectory_every"]; }

  void compare(const TaskPair& pair, const Read& a, const Read& b);
  Found difference(const Column& column, const TaskPair& pair, const Read& a, const Read& b);
  void add_ratios(const TaskPair& pair, const TaskRecord& a, const TaskRecord& b);
  void add_times(const TaskPair& pair, const TaskRecord& a, const TaskRecord& b);
  void add_time(const std::string& what, double a, double b);

  TaskReader a_, b_;
  AxisSizes sizes_a_, sizes_b_;
  const Plan* plan_a_;
  bool same_frames_;
  std::vector<ColumnDifference> found_;  ///< by place in columns()
  std::set<std::string> left_out_;
  std::vector<std::int64_t> draws_;                       ///< of the simulations that are ok in both
  std::vector<std::vector<double>> ratios_a_, ratios_b_;  ///< of each: by guess of a and tolerance
  std::vector<std::pair<std::string, std::vector<std::pair<double, double>>>> times_;
  SweepComparison result_;
};

Found Comparison::difference(const Column& column, const TaskPair& pair, const Read& a, const Read& b) {
  const Values values_a = column.values(const_cast<TaskRecord&>(a.record));  // which it only points into
  const Values values_b = column.values(const_cast<TaskRecord&>(b.record));
  return std::visit(
      [&](auto* here) {
        const auto* there = std::get<std::decay_t<decltype(here)>>(values_b);
        Found found;
        if (here->empty() && there->empty()) return found;
        const auto rows = static_cast<std::size_t>(a.task.rows[column.rows].count);
        const auto rows_b = static_cast<std::size_t>(b.task.rows[column.rows].count);
        if (rows != rows_b || here->empty() || there->empty()) {
          if (!here->empty() || !there->empty()) left_out_.insert(column.path);
          return found;
        }
        if (!has_guesses(column)) {
          if (here->size() == there->size())
            compare_values(here->data(), there->data(), here->size(), found);
          else
            left_out_.insert(column.path);
          return found;
        }
        const std::size_t block = guess_block(column, sizes_a_);
        const auto guesses_a = static_cast<std::size_t>(sizes_a_.guesses);
        const auto guesses_b = static_cast<std::size_t>(sizes_b_.guesses);
        for (std::size_t g = 0; g < pair.guesses.size(); ++g) {
          if (pair.guesses[g] < 0) continue;
          const auto other = static_cast<std::size_t>(pair.guesses[g]);
          for (std::size_t row = 0; row < rows; ++row)
            compare_values(here->data() + (row * guesses_a + g) * block,
                           there->data() + (row * guesses_b + other) * block, block, found);
        }
        return found;
      },
      values_a);
}

void Comparison::compare(const TaskPair& pair, const Read& a, const Read& b) {
  TaskDifference task{pair.a, pair.b, to_string(a.record.outcome), to_string(b.record.outcome), {}};
  for (std::size_t c = 0; c < columns().size(); ++c) {
    const Column& column = columns()[c];
    if (is_timing(column) || is_place(column)) continue;
    if (column.rows == Rows::frame_segment && !same_frames_) {
      if (a.task.frames > 0 || b.task.frames > 0) left_out_.insert(column.path);
      continue;
    }
    const Found found = difference(column, pair, a, b);
    if (found.values == 0) continue;
    task.columns.emplace_back(column.path);
    ColumnDifference& all = found_[c];
    ++all.tasks;
    all.values += found.values;
    if (found.largest > all.largest || all.task < 0) all.largest = found.largest, all.task = pair.a;
  }
  if (!task.columns.empty() || task.outcome_a != task.outcome_b) result_.differing.push_back(std::move(task));
}

void Comparison::add_ratios(const TaskPair& pair, const TaskRecord& a, const TaskRecord& b) {
  const auto width = static_cast<std::size_t>(sizes_a_.tolerances);
  std::vector<double> here(pair.guesses.size() * width, nan), there = here;
  for (std::size_t g = 0; g < pair.guesses.size(); ++g) {
    const auto other = static_cast<std::size_t>(std::max(pair.guesses[g], 0));
    if (pair.guesses[g] < 0 || (g + 1) * width > a.counted.cg_ratio.size() ||
        (other + 1) * width > b.counted.cg_ratio.size())
      continue;
    for (std::size_t t = 0; t < width; ++t) {
      const double x = a.counted.cg_ratio[g * width + t], y = b.counted.cg_ratio[other * width + t];
      if (std::isfinite(x) && std::isfinite(y)) here[g * width + t] = x, there[g * width + t] = y;
    }
  }
  ratios_a_.push_back(std::move(here));
  ratios_b_.push_back(std::move(there));
}

void Comparison::add_time(const std::string& what, double a, double b) {
  if (!(a > 0) || !(b > 0)) return;
  auto found = std::find_if(times_.begin(), times_.end(), [&](const auto& time) { return time.first == what; });
  if (found == times_.end()) found = times_.insert(times_.end(), {what, {}});
  found->second.emplace_back(a, b);
}

/// Of those that were measured; NaN of none.
double median_of(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }), values.end());
  if (values.empty()) return nan;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

/// A guess's median time over a task's solves, with CG.
double solve_time(const TaskRecord& record, std::size_t guess, std::size_t guesses) {
  std::vector<double> times;
  for (std::size_t i = guess; i < std::min(record.cg_s.size(), record.guess_s.size()); i += guesses)
    times.push_back(static_cast<double>(record.guess_s[i]) + static_cast<double>(record.cg_s[i]));
  return median_of(std::move(times));
}

void Comparison::add_times(const TaskPair& pair, const TaskRecord& a, const TaskRecord& b) {
  if (!a.elapsed_s.empty() && !b.elapsed_s.empty()) add_time("whole task", a.elapsed_s[0], b.elapsed_s[0]);
  add_time("direct solve", median_of({a.direct_s.begin(), a.direct_s.end()}),
           median_of({b.direct_s.begin(), b.direct_s.end()}));
  for (std::size_t g = 0; g < pair.guesses.size(); ++g)
    if (pair.guesses[g] >= 0)
      add_time("guess and CG, " + plan_a_->guess_labels()[g],
               solve_time(a, g, static_cast<std::size_t>(sizes_a_.guesses)),
               solve_time(b, static_cast<std::size_t>(pair.guesses[g]), static_cast<std::size_t>(sizes_b_.guesses)));
}

SweepComparison Comparison::finish() {
  for (std::size_t c = 0; c < found_.size(); ++c) {
    found_[c].path = columns()[c].path;
    if (found_[c].tasks > 0) result_.columns.push_back(std::move(found_[c]));
  }
  result_.left_out.assign(left_out_.begin(), left_out_.end());

  const auto tasks = static_cast<Eigen::Index>(draws_.size());
  const auto width = static_cast<std::size_t>(sizes_a_.tolerances);
  const auto ratios = static_cast<Eigen::Index>(width) * static_cast<Eigen::Index>(sizes_a_.guesses);
  Eigen::MatrixXd values(tasks, 3 * ratios);
  for (Eigen::Index task = 0; task < tasks; ++task)
    for (Eigen::Index i = 0; i < ratios; ++i) {
      const double a = ratios_a_[static_cast<std::size_t>(task)][static_cast<std::size_t>(i)];
      const double b = ratios_b_[static_cast<std::size_t>(task)][static_cast<std::size_t>(i)];
      values(task, i) = a, values(task, ratios + i) = b, values(task, 2 * ratios + i) = b - a;
    }
  const std::vector<Estimate> estimates = means(values, draws_);
  for (std::size_t i = 0; i < static_cast<std::size_t>(ratios); ++i) {
    const auto step = static_cast<std::size_t>(ratios);
    const std::string& label = plan_a_->guess_labels()[i / width];
    if (estimates[i].count > 0 && label != "zero")
      result_.ratios.push_back(
          {label, tolerance_ladder()[i % width], estimates[i], estimates[step + i], estimates[2 * step + i]});
  }
  for (const auto& [what, pairs] : times_) {
    std::vector<double> a, b, ratio;
    for (const auto& [here, there] : pairs) a.push_back(here), b.push_back(there), ratio.push_back(there / here);
    result_.times.push_back({what, median_of(a), median_of(b), median_of(ratio), static_cast<std::int64_t>(a.size())});
  }
  return std::move(result_);
}

}  // namespace

SweepComparison compare_sweeps(const fs::path& a, const Plan& plan_a, const fs::path& b, const Plan& plan_b,
                               const std::vector<TaskPair>& pairs) {
  Comparison comparison(a, plan_a, b, plan_b);
  for (const TaskPair& pair : pairs) comparison.add(pair);
  return comparison.finish();
}

}  // namespace rodsweep
