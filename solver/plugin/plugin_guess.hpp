// An initial guess from a shared library (plugin.h). Throws PluginError.
#pragma once

#include "solver/guess/initial_guess.hpp"
#include "solver/plugin/plugin.hpp"

namespace rodsweep {

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

}  // namespace rodsweep
