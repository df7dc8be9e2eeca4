#include "solver/plugin/plugin.hpp"

#include <dlfcn.h>

#include <vector>

#include "solver/rod/rod_arrays.hpp"

namespace rodsweep {
namespace {

rodsweep_rod view(const RodArrays& rod) {
  return {static_cast<int>(rod.length_m.size()),
          static_cast<int>(rod.joint_segments.size() / 2),
          rod.joint_segments.data(),
          rod.compliance.data(),
          rod.length_m.data(),
          rod.radius_m.data(),
          rod.mass_kg.data()};
}

}  // namespace

Plugin::Plugin(const PluginSource& source) : name_(source.name) {
  // Without a slash dlopen() would search the system's folders.
  const std::filesystem::path path = std::filesystem::absolute(source.library);
  handle_ = std::shared_ptr<void>(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* handle) {
    if (handle) dlclose(handle);
  });
  if (!handle_) throw error(std::string("cannot be loaded: ") + dlerror());
  void* symbol = dlsym(handle_.get(), "rodsweep_plugin");
  if (!symbol) throw error("does not export rodsweep_plugin()");
  functions_ = reinterpret_cast<const rodsweep_plugin_functions* (*)()>(symbol)();
  if (!functions_ || functions_->version != RODSWEEP_PLUGIN_VERSION)
    throw error("has version " + std::to_string(functions_ ? functions_->version : 0) + " of plugin.h; must be " +
                std::to_string(RODSWEEP_PLUGIN_VERSION) + ": compile it again");
  if (!functions_->create || !functions_->destroy) throw error("lacks create or destroy");
}

PluginInstance::PluginInstance(const PluginSource& source, const Rod* rods, int count)
    : plugin_(source), instance_(nullptr, functions().destroy), error_(RODSWEEP_ERROR_BYTES, '\0') {
  std::vector<RodArrays> arrays(rods, rods + count);
  std::vector<rodsweep_rod> views;
  for (const RodArrays& rod : arrays) views.push_back(view(rod));
  instance_.reset(functions().create(source.options.c_str(), views.data(), count, error()));
  if (!instance_) throw error(std::string(error_.c_str()));
}

int PluginInstance::checked(int returned) const {
  if (returned < 0) throw error(std::string(error_.c_str()));
  return returned;
}

rodsweep_system plugin_system(const Rod& rod, const LinearSystem& system, const SolvePosition& at) {
  const BlockMatrix& a = system.matrix();
  return {at.rod,
          at.step,
          at.newton,
          system.dt(),
          rod.joint_count(),
          rod.segment_count(),
          a.row_starts(),
          a.columns(),
          reinterpret_cast<const double*>(a.blocks.data()),
          system.rhs().data(),
          rod.lambda.data(),
          rod.position.front().data(),
          rod.orientation.front().coeffs().data()};
}

}  // namespace rodsweep
