#include "runner/file/attempt.hpp"

#include "runner/file/file_reading.hpp"

namespace rodsweep {

std::vector<Attempt> read_attempts(const std::filesystem::path& path) {
  return reading(path, [&] {
    const hdf5::File file = open_results(path);
    const auto seconds = hdf5::read_all<double>(file.id(), "/timing/tasks/elapsed_s");
    const auto steps = hdf5::read_all<std::int32_t>(file.id(), "/tasks/steps_done");
    std::vector<Attempt> attempts(seconds.size());
    for (std::size_t task = 0; task < attempts.size(); ++task)
      if (seconds[task] > 0) attempts[task] = {seconds[task], steps.at(task)};  // NaN: not measured
    return attempts;
  });
}

}  // namespace rodsweep
