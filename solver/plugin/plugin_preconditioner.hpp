// A preconditioner of CG from a shared library (plugin.h). Throws PluginError.
#pragma once

#include "solver/cg/block_preconditioner.hpp"
#include "solver/plugin/plugin.hpp"

namespace rodsweep {

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
