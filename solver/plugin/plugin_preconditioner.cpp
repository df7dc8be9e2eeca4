#include "solver/plugin/plugin_preconditioner.hpp"

#include <algorithm>

namespace rodsweep {

PluginPreconditioner::PluginPreconditioner(const PluginSource& source, const Rod& rod, int index,
                                           const LinearSystem& system)
    : rod_(rod), index_(index), system_(system), instance_(source, &rod, 1) {
  if (!instance_.functions().set_up || !instance_.functions().apply) throw instance_.error("lacks set_up or apply");
}

bool PluginPreconditioner::set_up(const BlockMatrix&) {
  const rodsweep_system system = plugin_system(rod_, system_, {-1, -1, index_});
  return instance_.call(instance_.functions().set_up, &system) > 0;
}

void PluginPreconditioner::apply(const double* r, double* z) {
  const Eigen::Index size = 6 * rod_.joint_count();
  std::fill_n(z, size, 0.0);  // a library that writes only a part gives the same each time
  instance_.call(instance_.functions().apply, r, z);
  if (!VectorX::Map(z, size).allFinite() && VectorX::Map(r, size).allFinite())
    throw instance_.error("apply() gave a vector that is not finite");
}

}  // namespace rodsweep
