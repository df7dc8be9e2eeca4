#include "runner/python/interpreter.hpp"

#include <dlfcn.h>
#include <omp.h>
#include <pthread.h>
#include <pybind11/embed.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "runner/python/opened_files.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;
namespace py = pybind11;

/// Rank 1, which is a worker, or a process that is alone.
bool prints() {
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  return !rank || std::string_view(rank) == (size && std::string_view(size) == "1" ? "0" : "1");
}

/// "3.12.1" of the lines "version = 3.12.1" (venv) or "version_info = 3.12.1.final.0" (virtualenv); else empty.
std::string version_of(const fs::path& environment) {
  std::ifstream in(environment / "pyvenv.cfg");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("version", 0) == 0)
      if (const std::size_t at = line.find_first_of("0123456789"); at != std::string::npos) return line.substr(at);
  return {};
}

constexpr int interrupting = SIGURG;
std::atomic<bool> unwanted{false};  ///< the call in progress
const pthread_t thread_of_python = pthread_self();
PyObject* exception = nullptr;

void install_interruption() {
  exception = PyErr_NewException("rodsweep_system.Interrupted", PyExc_BaseException, nullptr);
  if (!exception) throw py::error_already_set();
  const auto handler = [](const py::args&) {
    if (!unwanted) return;  // of an earlier call
    PyErr_SetString(exception, "the result is no longer wanted");
    throw py::error_already_set();
  };
  py::module_::import("signal").attr("signal")(interrupting, py::cpp_function(handler));
}

std::string home;   ///< the program's folder
bool left = false;  ///< whether the user's code left its folder

int notice(const char* event, PyObject*, void*) {
  if (std::strcmp(event, "os.chdir") == 0) left = true;
  return 0;
}

void go(const std::string& folder) { [[maybe_unused]] const int failed = chdir(folder.c_str()); }

/// Warns if the environment (VIRTUAL_ENV) is not one of the embedded Python's version, which then finds no packages in
/// it.
void check_environment(const std::string& environment) {
  const std::string own = std::to_string(PY_MAJOR_VERSION) + '.' + std::to_string(PY_MINOR_VERSION);
  std::error_code error;
  if (fs::exists(fs::path(environment) / "lib" / ("python" + own) / "site-packages", error)) return;
  const std::string other = version_of(environment);
  warn("VIRTUAL_ENV is " + environment + (other.empty() ? ", no environment of Python" : ", of Python " + other) +
       ": its packages are not found by rodsweep's Python " + own + "; make one with python" + own + " -m venv");
}

}  // namespace

void warn(const std::string& text) {
  if (prints()) std::fputs(("rodsweep: warning: " + text + '\n').c_str(), stderr);
}

void start_python() {
  if (Py_IsInitialized()) return;
  // numpy's libraries look for Python's symbols among all, but the program has loaded this one privately.
  if (Dl_info info; dladdr(reinterpret_cast<void*>(&Py_IsInitialized), &info))
    dlopen(info.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
  // Workers share the cores.
  if (!std::getenv("OMP_NUM_THREADS")) {
    setenv("OMP_NUM_THREADS", "1", 0);
    omp_set_num_threads(1);
  }
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  config.install_signal_handlers = 0;  // the program has its own
  config.write_bytecode = 0;           // nothing beside the user's files
  // sys.executable, which multiprocessing starts: not the first python3 of the PATH, which may be of another version.
  const char* environment = std::getenv("VIRTUAL_ENV");
  if (environment) check_environment(environment);
  const std::string python = environment ? std::string(environment) + "/bin/python" : RODSWEEP_PYTHON;
  PyConfig_SetBytesString(&config, &config.program_name, python.c_str());
  watch_opened_files();
  Visit::begin();
  py::initialize_interpreter(&config, 0, nullptr, false);
  py::module_::import("rodsweep_system");
  install_interruption();
  py::module_::import("numpy");  // arrays need it: not in the time of the first task
  py::module_ sys = py::module_::import("sys");
  sys.attr("stdout") = sys.attr("stderr");  // standard output has the program's results
  PyEval_SaveThread();
}

void begin_call() noexcept { unwanted = false; }

void interrupt_call() noexcept {
  unwanted = true;
  pthread_kill(thread_of_python, interrupting);
}

PyObject* interrupted() { return exception; }

Visit::Visit(std::string& folder) : folder_(folder) {
  if (!folder_.empty()) go(folder_);
  left = false;
}

Visit::~Visit() {
  std::error_code error;
  if (left) folder_ = fs::current_path(error).native();
  if (!folder_.empty()) go(home);
}

void Visit::begin() {
  home = fs::current_path().native();
  PySys_AddAuditHook(notice, nullptr);
}

}  // namespace rodsweep
