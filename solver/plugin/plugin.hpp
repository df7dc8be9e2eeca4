// A shared library with guesses and preconditioners of the user's (plugin.h), and an instance of it. PluginError: the
// library cannot be loaded, has another version, lacks a function or reports an error. A call whose result is no longer
// wanted ends in InterruptedComputation, with the library and its text.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "solver/guess/initial_guess.hpp"
#include "solver/plugin/plugin.h"
#include "solver/plugin/printable.hpp"
#include "solver/plugin/user_call.hpp"

namespace rodsweep {

class PluginError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct PluginSource {
  std::filesystem::path library;
  std::string options;  ///< for the library
  std::string name;     ///< in errors
};

/// A loaded library. It stays loaded as long as an instance of it exists.
class Plugin {
 public:
  explicit Plugin(const PluginSource& source);
  const rodsweep_plugin_functions& functions() const { return *functions_; }
  const char* name() const { return name_.c_str(); }
  /// rodsweep_plugin_interrupt(), or null.
  void (*interrupt() const)() { return interrupt_; }
  /// An error of the library, with its name.
  PluginError error(const std::string& text) const { return PluginError(printable(name_ + ": " + text)); }

 private:
  std::string name_;
  std::shared_ptr<void> handle_;
  const rodsweep_plugin_functions* functions_ = nullptr;
  void (*interrupt_)() = nullptr;
};

/// An instance for some rods.
class PluginInstance {
 public:
  PluginInstance(const PluginSource& source, const Rod* rods, int count);
  PluginInstance(const PluginInstance&) = delete;
  PluginInstance& operator=(const PluginInstance&) = delete;

  const rodsweep_plugin_functions& functions() const { return plugin_.functions(); }
  /// Returns what a function of the instance returns. Its first and last argument, instance and error, are added.
  template <class Function, class... Arguments>
  int call(Function function, Arguments... arguments) {
    const int returned = within_call([&] { return function(instance_.get(), arguments..., error_.data()); });
    if (returned < 0) throw error(error_.c_str());
    return returned;
  }
  PluginError error(const std::string& text) const { return plugin_.error(text); }

 private:
  struct Destroy {
    const Plugin* plugin;
    void operator()(void* instance) const;
  };
  template <class Part>
  auto within_call(const Part& part) {
    const auto returned = [&] {
      const UserCall call(plugin_.name(), plugin_.interrupt());
      return part();
    }();
    if (is_interrupted(0)) throw_interrupted();
    return returned;
  }
  [[noreturn]] void throw_interrupted() const;

  Plugin plugin_;
  std::string error_;  ///< RODSWEEP_ERROR_BYTES for the library to write to
  std::unique_ptr<void, Destroy> instance_;
};

/// What a plug-in is told of a system. It points into the arguments.
rodsweep_system plugin_system(const Rod& rod, const LinearSystem& system, const SolvePosition& at);

}  // namespace rodsweep
