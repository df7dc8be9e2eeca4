// A shared library with guesses and preconditioners of the user's (plugin.h), an instance of it, and both of these. PluginError: the
// library cannot be loaded, has another version, lacks a function or reports an error. A call whose result is no longer
// wanted ends in InterruptedComputation, with the library and its text.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "solver/cg/block_preconditioner.hpp"
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

/// An initial guess from a shared library. Throws PluginError.
class PluginGuess : public InitialGuess {
 public:
  PluginGuess(const PluginSource& source, const Scene& scene);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
  void accept_total(int rod, int step, const VectorX& total) override;

 private:
  rodsweep_system view(const LinearSystem& system, const SolvePosition& at) const;

  const Scene& scene_;
  PluginInstance instance_;
};

/// A preconditioner of CG from a shared library. Throws PluginError.
class PluginPreconditioner : public BlockPreconditioner {
 public:
  /// `rod`, which is `index` in its scene, and `system` must outlive it.
  PluginPreconditioner(const PluginSource& source, const Rod& rod, int index, const LinearSystem& system);

  /// For the system as it is assembled, whose matrix is the argument.
  bool set_up(const BlockMatrix&) override;
  void apply(const double* r, double* z) override;

 private:
  const Rod& rod_;
  int index_;
  const LinearSystem& system_;
  PluginInstance instance_;
};

}  // namespace rodsweep
