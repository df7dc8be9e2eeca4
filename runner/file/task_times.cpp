#include "runner/file/task_times.hpp"

#include "runner/file/file_reading.hpp"

namespace rodsweep {

TaskTimes read_task_times(const std::filesystem::path& path) {
  return reading(path, [&] {
    const hdf5::File file = open_results(path);
    TaskTimes times{hdf5::read_all<double>(file.id(), "/timing/tasks/elapsed_s"), {}};
    const auto seconds = hdf5::read_all<double>(file.id(), "/timing/tasks/tried_s");
    const auto steps = hdf5::read_all<std::int32_t>(file.id(), "/timing/tasks/tried_steps");
    for (std::size_t task = 0; task < seconds.size(); ++task) times.tried.push_back({seconds[task], steps.at(task)});
    return times;
  });
}

}  // namespace rodsweep
