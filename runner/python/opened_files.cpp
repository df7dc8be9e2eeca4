#include "runner/python/opened_files.hpp"

#include <Python.h>
#include <fcntl.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>

#include "runner/python/interpreter.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

struct Opened {
  std::vector<std::string> files;  ///< in order
  std::set<std::string> told;
};

// Used with the interpreter's lock only.
const std::string* watched = nullptr;  ///< the module
std::size_t count = 0;
std::map<std::string, Opened>& opened() {
  static std::map<std::string, Opened> by_module;
  return by_module;
}
std::set<std::string>& written() {
  static std::set<std::string> files;
  return files;
}

std::string resolved(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path), found = fs::weakly_canonical(whole, error);
  return (error ? whole : found).native();
}

/// "net.py" for "__pycache__/net.cpython-311.pyc".
fs::path source_of(const fs::path& path) {
  if (path.extension() != ".pyc" || path.parent_path().filename() != "__pycache__") return path;
  const std::string name = path.filename().native();
  return path.parent_path().parent_path() / (name.substr(0, name.find('.')) + ".py");
}

bool is_of_the_system(const std::string& path) {
  for (const char* folder : {"/dev/", "/etc/", "/lib/", "/proc/", "/run/", "/sys/", "/usr/lib/", "/usr/share/"})
    if (path.rfind(folder, 0) == 0) return true;
  for (const char* part : {"/lib/python", "/dist-packages/", "/site-packages/"})
    if (path.find(part) != std::string::npos) return true;
  return false;
}

void notice(const fs::path& path, bool writes) {
  const std::string file = resolved(source_of(path));
  if (writes) {
    written().insert(file);
    return;
  }
  std::error_code error;
  if (!watched || file == resolved(*watched) || is_of_the_system(file) || written().count(file) ||
      !fs::is_regular_file(file, error))
    return;
  std::vector<std::string>& files = opened()[*watched].files;
  if (std::find(files.begin(), files.end(), file) != files.end()) return;
  files.push_back(file);
  ++count;
}

/// The event "open" has path, mode and flags.
int audit(const char* event, PyObject* args, void*) {
  if (std::strcmp(event, "open") != 0 || !PyTuple_Check(args) || PyTuple_Size(args) != 3) return 0;
  PyObject* bytes = nullptr;
  if (!PyUnicode_FSConverter(PyTuple_GetItem(args, 0), &bytes)) {  // the number of an open file
    PyErr_Clear();
    return 0;
  }
  const long flags = PyLong_AsLong(PyTuple_GetItem(args, 2));
  PyErr_Clear();
  try {
    notice(PyBytes_AsString(bytes), (flags & O_ACCMODE) != O_RDONLY);
  } catch (const std::exception&) {  // a path that cannot be resolved
  }
  Py_DECREF(bytes);
  return 0;
}

std::string listed(const std::vector<std::string>& files, const char* quote) {
  std::string text;
  for (const std::string& file : files) text += (text.empty() ? "" : ", ") + (quote + file) + quote;
  return text;
}

}  // namespace

void watch_opened_files() { PySys_AddAuditHook(audit, nullptr); }

Watching::Watching(const std::string& module) : before_(watched) { watched = &module; }
Watching::~Watching() { watched = before_; }

std::size_t opened_files() { return count; }

void warn_of_unnamed(const std::string& module, const std::vector<std::string>& inputs) {
  const auto found = opened().find(module);
  if (found == opened().end()) return;
  const fs::path folder = fs::path(resolved(module)).parent_path();
  const auto shown = [&](const std::string& file) { return fs::path(file).lexically_proximate(folder).native(); };
  std::set<std::string> named;
  std::vector<std::string> needed, unnamed;
  for (const std::string& input : inputs)
    if (named.insert(resolved(input)).second) needed.push_back(shown(resolved(input)));
  for (const std::string& file : found->second.files) {
    if (named.count(file)) continue;
    needed.push_back(shown(file));
    if (found->second.told.insert(file).second) unnamed.push_back(shown(file));
  }
  if (!unnamed.empty())
    warn(fs::path(module).filename().native() + " opened " + listed(unnamed, "") +
         ", which the job does not name: results of changed contents would be mixed with old ones. Write beside "
         "\"file\", with paths from the job's folder: \"inputs\": [" +
         listed(needed, "\"") + "]");
}

}  // namespace rodsweep
