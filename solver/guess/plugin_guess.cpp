#include "solver/guess/plugin_guess.hpp"

#include <dlfcn.h>

#include <algorithm>

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

Plugin::Plugin(const std::filesystem::path& library) : library_(library) {
  // Without a slash dlopen() would search the system's folders.
  const std::filesystem::path path = std::filesystem::absolute(library);
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
  if (!functions_->create || !functions_->destroy || !functions_->propose)
    throw error("lacks create, destroy or propose");
}

PluginError Plugin::error(const std::string& text) const {
  return PluginError("plug-in " + library_.filename().native() + ": " + text);
}

PluginGuess::PluginGuess(const std::filesystem::path& library, const std::string& options, const Scene& scene)
    : scene_(scene),
      plugin_(library),
      instance_(nullptr, plugin_.functions().destroy),
      error_(RODSWEEP_ERROR_BYTES, '\0') {
  std::vector<RodArrays> arrays;
  for (const Rod& rod : scene.rods) arrays.emplace_back(rod);
  std::vector<rodsweep_rod> rods;
  for (const RodArrays& rod : arrays) rods.push_back(view(rod));
  instance_.reset(
      plugin_.functions().create(options.c_str(), rods.data(), static_cast<int>(rods.size()), error_.data()));
  if (!instance_) throw plugin_.error(error_.c_str());
}

Proposal PluginGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const BlockMatrix& a = system.matrix();
  const Rod& rod = scene_.rods[static_cast<std::size_t>(at.rod)];
  system_ = {at.rod,
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
  int products = 0;
  const int found = plugin_.functions().propose(instance_.get(), &system_, x0.data(), &products, error_.data());
  if (found < 0) throw plugin_.error(error_.c_str());
  if (found == 0) x0.setZero();
  if (!x0.allFinite()) throw plugin_.error("proposed a guess that is not finite");
  return {found != 0, std::max(products, 0)};
}

void PluginGuess::accept(const SolvePosition&, const VectorX& solution) {
  const auto accept = plugin_.functions().accept;
  if (accept && accept(instance_.get(), &system_, solution.data(), error_.data()) < 0)
    throw plugin_.error(error_.c_str());
}

}  // namespace rodsweep
