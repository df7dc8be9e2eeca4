#include "solver/plugin/plugin.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
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

/// The size that an ELF file must have for its segments and tables; 0 if it is another file.
std::uintmax_t least_size(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  ElfW(Ehdr) header{};
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!file || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_phentsize != sizeof(ElfW(Phdr))) return 0;
  std::uintmax_t size = header.e_phoff + std::uintmax_t{header.e_phnum} * header.e_phentsize;
  size = std::max<std::uintmax_t>(size, header.e_shoff + std::uintmax_t{header.e_shnum} * header.e_shentsize);
  file.seekg(static_cast<std::streamoff>(header.e_phoff));
  ElfW(Phdr) segment{};
  for (int i = 0; i < header.e_phnum && file.read(reinterpret_cast<char*>(&segment), sizeof segment); ++i)
    size = std::max<std::uintmax_t>(size, segment.p_offset + segment.p_filesz);
  return size;
}

/// Returns to the program's folder, which a library may have left. The system call takes as long as a short call of a
/// library, so only the first and the last call of an instance have it.
void return_to_folder() {
  static const int folder = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
  [[maybe_unused]] const int failed = fchdir(folder);
}

}  // namespace

Plugin::Plugin(const PluginSource& source) : name_(source.name) {
  return_to_folder();
  // Without a slash dlopen() would search the system's folders.
  const std::filesystem::path path = std::filesystem::absolute(source.library);
  std::error_code unreadable;
  const std::uintmax_t size = std::filesystem::file_size(path, unreadable), least = least_size(path);
  if (!unreadable && size < least)  // dlopen() would map what is not there, and end the process
    throw error("is incomplete: it has " + std::to_string(size) + " of " + std::to_string(least) +
                " bytes: compile or copy it again");
  const UserCall call(name());
  handle_ = std::shared_ptr<void>(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* handle) {
    if (handle) dlclose(handle);
  });
  if (!handle_) throw error(std::string("cannot be loaded: ") + dlerror());
  void* symbol = dlsym(handle_.get(), "rodsweep_plugin");
  if (!symbol) throw error("does not export rodsweep_plugin()");
  functions_ = reinterpret_cast<const rodsweep_plugin_functions* (*)()>(symbol)();
  interrupt_ = reinterpret_cast<void (*)()>(dlsym(handle_.get(), "rodsweep_plugin_interrupt"));
  if (!functions_ || functions_->version != RODSWEEP_PLUGIN_VERSION)
    throw error("has version " + std::to_string(functions_ ? functions_->version : 0) + " of plugin.h; must be " +
                std::to_string(RODSWEEP_PLUGIN_VERSION) + ": compile it again");
  if (!functions_->create || !functions_->destroy) throw error("lacks create or destroy");
}

PluginInstance::PluginInstance(const PluginSource& source, const Rod* rods, int count)
    : plugin_(source), error_(RODSWEEP_ERROR_BYTES, '\0'), instance_(nullptr, {&plugin_}) {
  std::vector<RodArrays> arrays(rods, rods + count);
  std::vector<rodsweep_rod> views;
  for (const RodArrays& rod : arrays) views.push_back(view(rod));
  const bool made = within_call([&] {
    instance_.reset(functions().create(source.options.c_str(), views.data(), count, error_.data()));
    return_to_folder();
    return instance_ != nullptr;
  });
  if (!made) throw error(error_.c_str());
}

void PluginInstance::Destroy::operator()(void* instance) const {
  const UserCall call(plugin->name(), plugin->interrupt());
  plugin->functions().destroy(instance);
  return_to_folder();
}

void PluginInstance::throw_interrupted() const {
  const std::string text = error_.c_str();
  throw_interruption(plugin_.name() + (text.empty() ? text : " (" + text + ')'));
}

/// What a plug-in is told of a system. It points into the arguments.
static rodsweep_system plugin_system(const Rod& rod, const LinearSystem& system, const SolvePosition& at) {
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

PluginGuess::PluginGuess(const PluginSource& source, const Scene& scene)
    : scene_(scene), instance_(source, scene.rods.data(), static_cast<int>(scene.rods.size())) {
  if (!instance_.functions().propose) throw instance_.error("lacks propose");
}

rodsweep_system PluginGuess::view(const LinearSystem& system, const SolvePosition& at) const {
  return plugin_system(scene_.rods[static_cast<std::size_t>(at.rod)], system, at);
}

Proposal PluginGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const rodsweep_system seen = view(system, at);
  int products = 0;
  const bool nonzero = instance_.call(instance_.functions().propose, &seen, x0.data(), &products) > 0;
  if (!nonzero) x0.setZero();
  if (!x0.allFinite()) throw instance_.error("proposed a guess that is not finite");
  if (products < 0 || products > RODSWEEP_MOST_PRODUCTS)
    throw instance_.error("counted " + std::to_string(products) + " products with A; must be from 0 to " +
                          std::to_string(RODSWEEP_MOST_PRODUCTS));
  return {nonzero, products};
}

void PluginGuess::accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
  const auto accept = instance_.functions().accept;
  if (!accept) return;
  const rodsweep_system seen = view(system, at);
  instance_.call(accept, &seen, solution.data());
}

void PluginGuess::accept_total(int rod, int step, const VectorX& total) {
  if (const auto accept_total = instance_.functions().accept_total)
    instance_.call(accept_total, rod, step, total.data());
}

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
