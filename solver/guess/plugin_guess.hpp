// An initial guess from a shared library (plugin.h). Throws PluginError if the library cannot be loaded, has another
// version or reports an error.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "solver/guess/initial_guess.hpp"
#include "solver/guess/plugin.h"

namespace rodsweep {

class PluginError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A loaded library. It stays loaded as long as an instance of it exists.
class Plugin {
 public:
  explicit Plugin(const std::filesystem::path& library);
  const rodsweep_plugin_functions& functions() const { return *functions_; }
  /// An error of the library, with its name.
  PluginError error(const std::string& text) const;

 private:
  std::filesystem::path library_;
  std::shared_ptr<void> handle_;
  const rodsweep_plugin_functions* functions_ = nullptr;
};

class PluginGuess : public InitialGuess {
 public:
  PluginGuess(const std::filesystem::path& library, const std::string& options, const Scene& scene);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition& at, const VectorX& solution) override;

 private:
  const Scene& scene_;
  Plugin plugin_;
  std::unique_ptr<void, void (*)(void*)> instance_;
  rodsweep_system system_{};  ///< last proposed for
  std::string error_;         ///< RODSWEEP_ERROR_BYTES for the library to write to
};

}  // namespace rodsweep
