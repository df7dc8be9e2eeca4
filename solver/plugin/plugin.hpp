// A shared library with guesses and preconditioners of the user's (plugin.h), and an instance of it. PluginError: the
// library cannot be loaded, has another version, lacks a function or reports an error.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "solver/guess/initial_guess.hpp"
#include "solver/plugin/plugin.h"
#include "solver/plugin/printable.hpp"

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
  /// An error of the library, with its name.
  PluginError error(const std::string& text) const { return PluginError(printable(name_ + ": " + text)); }

 private:
  std::string name_;
  std::shared_ptr<void> handle_;
  const rodsweep_plugin_functions* functions_ = nullptr;
};

/// An instance for some rods. Its functions' last argument is error().
class PluginInstance {
 public:
  PluginInstance(const PluginSource& source, const Rod* rods, int count);

  const rodsweep_plugin_functions& functions() const { return plugin_.functions(); }
  void* get() const { return instance_.get(); }
  char* error() { return error_.data(); }
  /// Returns what a function returned; throws if that says that error() has a text.
  int checked(int returned) const;
  PluginError error(const std::string& text) const { return plugin_.error(text); }

 private:
  Plugin plugin_;
  std::unique_ptr<void, void (*)(void*)> instance_;
  std::string error_;  ///< RODSWEEP_ERROR_BYTES for the library to write to
};

/// What a plug-in is told of a system. It points into the arguments.
rodsweep_system plugin_system(const Rod& rod, const LinearSystem& system, const SolvePosition& at);

}  // namespace rodsweep
