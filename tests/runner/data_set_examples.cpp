#include "tests/runner/data_set_examples.hpp"

#include <stdexcept>

#include "runner/measure/run_task.hpp"

namespace rodsweep {

TaskRecord record_of(const Plan& plan, std::int64_t index) {
  const Task task = plan.task(index);
  TaskRecord record;
  record.prepare(task, axis_sizes(plan));
  if (!run_task(task, plan.spec(index), record)) throw std::logic_error("abandoned");
  return record;
}

TaskRecord record_of(const Json& job, std::int64_t task) { return record_of(plan_of(job), task); }

std::vector<std::size_t> rows_run(const TaskRecord& record) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < record.solves.newton.size(); ++row)
    if (record.solves.newton[row] >= 0) rows.push_back(row);
  return rows;
}

Json five_steps(const std::string& guesses, const std::string& solve) {
  return with("/time/steps", "5", with("/guesses", guesses, with("/solve", solve)));
}

Plan make_data_set(const std::filesystem::path& path, const Json& job, std::int64_t failing, bool pending) {
  const Plan plan = plan_of(job);
  ResultsFile file = ResultsFile::create(path, plan, test_provenance(), MPI_COMM_SELF);
  for (const Task& task : plan.tasks()) {
    if (pending && task.index >= failing) continue;
    TaskRecord record = record_of(plan, task.index);
    if (task.index >= failing) record.outcome = TaskOutcome::diverged, record.message = "step 2: too bad";
    file.write(task, record);
  }
  file.close();
  return plan;
}

Json ragged_job() {
  Json job = data_job();
  job["samples"] = 3;
  job["seed"] = 4;
  job["scene"]["segments"] = {{"integer", {4, 12}}};
  job["scene"]["damping_per_s"] = 0.5;
  return job;
}

void damage(const std::filesystem::path& path, const Plan& plan) {
  const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDWR);
  const auto row = static_cast<hsize_t>(plan.task(1).rows[Rows::system_joint].first);
  const std::vector<double> wrong(6, 0.5);
  hdf5::RowDataset(file.id(), "/systems/joints/solution").write(hdf5::type_of<double>(), row, 1, wrong.data());
}

}  // namespace rodsweep
