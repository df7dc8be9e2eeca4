// How much memory this host has for its processes, and a bound for this one, so that a task that wants more ends in an
// error of its own (std::bad_alloc) and not in the death of its process by the kernel's hand.
#pragma once

#include <filesystem>
#include <string>

namespace rodsweep {

/// Bytes: what the machine has, or the least that a control group of this process allows (Slurm and containers set
/// them). `root` and `proc` stand for / and /proc in tests.
double host_memory(const std::filesystem::path& root = "/", const std::filesystem::path& proc = "/proc");

/// Share of the host's memory that is left to everything else.
inline constexpr double memory_reserve = 0.1;

/// For good: what this process allocates from now on beyond `bytes` in all is refused. Nothing where the system cannot.
void limit_memory(double bytes);

/// Bytes that this process may still allocate; infinity where nothing bounds it.
double memory_left();

/// How to have more: "fewer ranks on a host leave each more, --memory-limit-gb sets it".
extern const char* const more_memory_text;

/// "out of memory: ..." with this process's bound, for messages.
std::string out_of_memory_text();

/// Bytes: the most memory that this process has had at a time. 0: not known.
double peak_memory();

}  // namespace rodsweep
