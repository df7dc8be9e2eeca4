// An initial guess from a shared library (plugin.h). Throws PluginError.
#pragma once

#include "solver/guess/initial_guess.hpp"
#include "solver/plugin/plugin.hpp"

namespace rodsweep {

class PluginGuess : public InitialGuess {
 public:
  PluginGuess(const PluginSource& source, const Scene& scene);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition& at, const VectorX& solution) override;

 private:
  const Scene& scene_;
  PluginInstance instance_;
  rodsweep_system system_{};  ///< last proposed for
};

}  // namespace rodsweep
