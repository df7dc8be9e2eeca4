// What a worker does with one task of a sweep that extends an earlier file (runner/file/extension.hpp): copies it,
// completes it, or runs it like any other.
#pragma once

#include <functional>
#include <string>

#include "runner/experiment/task_body.hpp"
#include "runner/file/extension.hpp"

namespace rodsweep {

/// `origin`: who ran the task, where it was copied whole; else nullptr.
using WriteExtended = std::function<void(const Task&, const TaskRecord&, const TaskOrigin* origin)>;

/// A source that is damaged is reported to `warn`, and its task run. A trajectory that is not, to the last bit, what it
/// was is a FileError naming the task. Plan and extension must outlive the body.
TaskBody extending_body(const Plan& plan, const Extension& extension, Evaluate evaluate, WriteExtended write,
                        std::function<void(const std::string&)> warn);

}  // namespace rodsweep
