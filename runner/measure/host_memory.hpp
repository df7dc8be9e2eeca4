// The host's memory, and a memory limit for this process. A task that exceeds the limit fails with std::bad_alloc,
// before the kernel's out-of-memory killer ends the process.
#pragma once

#include <filesystem>
#include <string>

namespace rodsweep {

/// Bytes: the physical memory or the lowest limit of this process's control groups (set by Slurm and containers).
/// Tests replace / and /proc by `root` and `proc`.
double host_memory(const std::filesystem::path& root = "/", const std::filesystem::path& proc = "/proc");

/// Share of the host's memory reserved for other processes.
inline constexpr double memory_reserve = 0.1;

/// Permanently limits the memory of this process to `bytes`; allocations beyond fail. No effect if the system refuses.
void limit_memory(double bytes);

/// Bytes that this process may still allocate; infinity without a limit.
double memory_left();

/// Advice for messages: how to give a rank more memory.
extern const char* const more_memory_text;

/// "out of memory: ..." with this process's limit, for messages.
std::string out_of_memory_text();

/// Peak memory of this process in bytes; 0: unknown.
double peak_memory();

}  // namespace rodsweep
