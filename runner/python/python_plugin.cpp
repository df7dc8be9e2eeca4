// Guesses and preconditioners in Python (docs/own-guess.md): a plug-in (solver/plugin/plugin.h) that embeds the
// interpreter, so that the program itself does not need Python.
//
// Its options are parts, each on a line but the last: the class, Guess or Preconditioner; the file that has it; the
// number of other files that it reads, and their paths; the text of the job. Python receives copies, since it may keep
// them longer than their memory exists. The arrays have the names and shapes of rodsweep.systems().
#include <pybind11/embed.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "runner/python/interpreter.hpp"
#include "runner/python/opened_files.hpp"
#include "solver/plugin/plugin.h"

namespace py = pybind11;
using namespace py::literals;

namespace {

using Array = py::array_t<double>;
using Shape = std::vector<py::ssize_t>;

template <class T>
py::array_t<T> copied(const T* data, const Shape& shape) {
  return py::array_t<T>(shape, data);
}

py::object rod_of(const rodsweep_rod& rod) {
  return py::module_::import("types").attr("SimpleNamespace")(
      "segments"_a = copied(rod.joint_segments, {rod.joints, 2}),
      "compliance_per_j"_a = copied(rod.compliance, {rod.joints, 6}),
      "length_m"_a = copied(rod.length_m, {rod.segments}), "radius_m"_a = copied(rod.radius_m, {rod.segments}),
      "mass_kg"_a = copied(rod.mass_kg, {rod.segments}));
}

/// What Python sees of a system. Each attribute is copied when it is read.
class System {
 public:
  System(const rodsweep_system& system, py::object rod) : system_(&system), rod_(std::move(rod)) {}
  /// The call that it was passed to has ended.
  void end() { system_ = nullptr; }

  const rodsweep_system& now() const {
    if (!system_)
      throw std::runtime_error("a system can be read during the call that it is passed to: keep its arrays instead");
    return *system_;
  }
  py::object rod() const { return rod_; }
  Array joint_vector(const double* data) const { return copied(data, {6 * now().joints}); }
  Array blocks() const {
    const int count = now().row_begin[now().joints];
    Array blocks(Shape{count, 6, 6});
    auto to = blocks.mutable_unchecked<3>();
    for (int k = 0; k < count; ++k)
      for (int r = 0; r < 6; ++r)
        for (int c = 0; c < 6; ++c) to(k, r, c) = now().blocks[48 * k + 8 * c + r];
    return blocks;
  }
  py::object matrix() const {
    const int joints = now().joints;
    return py::module_::import("scipy.sparse")
        .attr("bsr_matrix")(py::make_tuple(blocks(), copied(now().columns, {now().row_begin[joints]}),
                                           copied(now().row_begin, {joints + 1})),
                            "shape"_a = py::make_tuple(6 * joints, 6 * joints));
  }
  Array orientation() const {
    const int segments = now().segments;
    Array wxyz(Shape{segments, 4});
    auto to = wxyz.mutable_unchecked<2>();
    for (int s = 0; s < segments; ++s)
      for (int k = 0; k < 4; ++k) to(s, k) = now().orientation[4 * s + (k + 3) % 4];
    return wxyz;
  }

 private:
  const rodsweep_system* system_;
  py::object rod_;
};

PYBIND11_EMBEDDED_MODULE(rodsweep_system, module) {
  py::class_<System>(module, "System")
      .def_property_readonly("of", &System::rod)
      .def_property_readonly("rod", [](const System& s) { return s.now().rod; })
      .def_property_readonly("step", [](const System& s) { return s.now().step; })
      .def_property_readonly("newton", [](const System& s) { return s.now().newton; })
      .def_property_readonly("dt_s", [](const System& s) { return s.now().dt_s; })
      .def_property_readonly("A", &System::matrix)
      .def_property_readonly("blocks", &System::blocks)
      .def_property_readonly("b", [](const System& s) { return s.joint_vector(s.now().b); })
      .def_property_readonly("multipliers", [](const System& s) { return s.joint_vector(s.now().multipliers); })
      .def_property_readonly("position_m",
                             [](const System& s) {
                               return copied(s.now().position_m, {s.now().segments, 3});
                             })
      .def_property_readonly("orientation", &System::orientation);
}

/// "ValueError: TEXT (my_guess.py:12 in propose)"; of a call that was interrupted only the place
std::string text_of(const py::error_already_set& error) {
  const auto text = [](const py::handle& object) -> std::string {
    try {
      return py::str(object).attr("encode")("utf-8", "replace").cast<std::string>();
    } catch (const py::error_already_set&) {
      return "(its text cannot be shown: __str__ failed)";
    }
  };
  std::string places;
  if (error.trace())
    for (const py::handle frame : py::module_::import("traceback").attr("extract_tb")(error.trace())) {
      const std::string file = text(frame.attr("filename"));
      if (file.empty() || file.front() == '<') continue;  // of importlib
      places += (places.empty() ? "" : ", ") + file.substr(file.rfind('/') + 1) + ':' + text(frame.attr("lineno")) +
                " in " + text(frame.attr("name"));
    }
  if (error.matches(rodsweep::interrupted())) return places;
  const std::string what = text(error.type().attr("__name__")) + ": " + text(error.value());
  return places.empty() ? what : what + " (" + places + ')';
}

void write(std::string text, char* error) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (text.size() >= RODSWEEP_ERROR_BYTES) {
    std::size_t end = RODSWEEP_ERROR_BYTES - 1;
    while ((static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // no part of a character
    text.resize(end);
  }
  std::snprintf(error, RODSWEEP_ERROR_BYTES, "%s", text.c_str());
}

/// What `call` returns, or `failed` with the text of its exception.
template <class Result, class Call>
Result guarded(Result failed, char* error, const Call& call) {
  rodsweep::begin_call();
  py::gil_scoped_acquire lock;
  try {
    return call();
  } catch (const py::error_already_set& raised) {
    write(text_of(raised), error);
  } catch (const std::exception& raised) {
    write(raised.what(), error);
  }
  return failed;
}

/// Copies an array that Python returned.
void read(const py::object& returned, double* to, int size, const std::string& function) {
  const py::array array = py::module_::import("numpy").attr("asarray")(returned);
  const auto said = [&](const py::handle& what) {
    return function + " returned an array of " + py::str(what).cast<std::string>();
  };
  if (array.dtype().kind() != 'f') throw std::invalid_argument(said(array.dtype()) + "; must be of float64 or float32");
  const bool flat = array.ndim() == 1 && array.shape(0) == size;
  if (!flat && !(array.ndim() == 2 && array.shape(0) == size / 6 && array.shape(1) == 6))
    throw std::invalid_argument(said(array.attr("shape")) + "; must be of (" + std::to_string(size) + ",) or (" +
                                std::to_string(size / 6) + ", 6)");
  const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>(array);
  std::copy_n(values.data(), size, to);
}

/// A number of products. One that does not fit is refused like any other that is too large.
int count_of(const py::object& products) {
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(products.ptr()));
  if (!whole) {
    PyErr_Clear();
    throw std::invalid_argument("propose() returned (x0, " + py::repr(products).cast<std::string>() +
                                "); the second must be the number of products with A, an int");
  }
  int overflow = 0;
  const long count = PyLong_AsLongAndOverflow(whole.ptr(), &overflow);
  const auto as_int = static_cast<int>(count);
  if (overflow == 0 && as_int == count) return as_int;
  return overflow < 0 || (overflow == 0 && count < 0) ? std::numeric_limits<int>::min()
                                                      : std::numeric_limits<int>::max();
}

struct Instance {
  py::object own;
  std::string folder;  ///< see Visit
  std::string file;
  std::vector<std::string> inputs;  ///< of the job
  std::size_t told = 0;             ///< opened_files() at the last warning
  std::vector<py::object> rods;
  int joints = 0;  ///< of the preconditioner's rod

  /// Calls a method with a system that lasts as long as the call.
  template <class... More>
  py::object call(const char* method, const rodsweep_system& system, const More&... more) {
    const std::size_t rod = rods.size() == 1 ? 0 : static_cast<std::size_t>(system.rod);
    py::object made = py::cast(System(system, rods[rod]));
    struct Ended {
      System& system;
      ~Ended() { system.end(); }
    } ended{made.cast<System&>()};
    return within([&] { return own.attr(method)(made, more...); });
  }

  /// What a call into the user's code returns. Tells the user of files that it opened.
  template <class Call>
  py::object within(const Call& call) {
    py::object returned;
    {
      const rodsweep::Visit visit(folder);
      const rodsweep::Watching watching(file);
      returned = call();
    }
    if (const std::size_t opened = rodsweep::opened_files(); opened != told) {
      told = opened;
      rodsweep::warn_of_unnamed(file, inputs);
    }
    return returned;
  }
};

/// A file that was executed.
struct Loaded {
  py::object module;
  std::string folder;  ///< see Visit
};

/// Each file is executed once, so that the weights it loads are read once.
const Loaded& loaded(const std::string& path) {
  static std::map<std::string, Loaded>& files = *new std::map<std::string, Loaded>;  // outlives the interpreter
  if (const auto found = files.find(path); found != files.end()) return found->second;
  const std::size_t slash = path.rfind('/') + 1;
  const std::string folder = path.substr(0, slash), name = path.substr(slash, path.rfind('.') - slash);
  py::list places = py::module_::import("sys").attr("path");
  if (!places.contains(folder)) places.insert(0, folder);
  py::module_ util = py::module_::import("importlib.util");
  py::object spec = util.attr("spec_from_file_location")(name, path);
  if (spec.is_none()) throw std::invalid_argument("the name of a Python file ends in .py");
  Loaded made{util.attr("module_from_spec")(spec), ""};
  py::module_::import("sys").attr("modules")[name.c_str()] = made.module;
  {
    const rodsweep::Visit visit(made.folder);
    const rodsweep::Watching watching(path);
    spec.attr("loader").attr("exec_module")(made.module);
  }
  return files.emplace(path, std::move(made)).first->second;
}

/// Without rods: loads the file and checks it.
void* create(const char* options, const rodsweep_rod* rods, int count, char* error) {
  std::string text = options;
  const auto next_line = [&text] {
    const std::size_t end = text.find('\n');
    const std::string line = text.substr(0, end);
    text.erase(0, end + 1);
    return line;
  };
  const std::string name = next_line(), path = next_line();
  std::vector<std::string> inputs(std::stoul(next_line()));
  for (std::string& input : inputs) input = next_line();
  try {
    rodsweep::start_python();
  } catch (const std::exception& raised) {
    write(raised.what(), error);
    return nullptr;
  }
  return guarded<void*>(nullptr, error, [&]() -> void* {
    const Loaded& file = loaded(path);
    const char* method = name == "Guess" ? "propose" : "apply";
    const py::object own = py::getattr(file.module, name.c_str(), py::none());
    if (!py::hasattr(own, method)) throw std::invalid_argument("has no class " + name + " with " + method + "()");
    auto made = std::make_unique<Instance>();
    made->folder = file.folder;
    made->file = path;
    made->inputs = inputs;
    for (int rod = 0; rod < count; ++rod) made->rods.push_back(rod_of(rods[rod]));
    if (count > 0) {
      made->joints = rods[0].joints;
      py::list list;
      for (const py::object& rod : made->rods) list.append(rod);
      made->own = made->within([&] { return own(list, text); });
    }
    return made.release();
  });
}

void destroy(void* instance) {
  py::gil_scoped_acquire lock;
  delete static_cast<Instance*>(instance);
}

int propose(void* instance, const rodsweep_system* system, double* x0, int* products, char* error) {
  return guarded(-1, error, [&] {
    py::object x = static_cast<Instance*>(instance)->call("propose", *system);
    if (x.is_none()) return 0;
    if (py::isinstance<py::tuple>(x) && py::len(x) == 2) {
      *products = count_of(x[py::int_(1)]);
      x = x[py::int_(0)];
    }
    read(x, x0, 6 * system->joints, "propose()");
    return 1;
  });
}

int accept(void* instance, const rodsweep_system* system, const double* solution, char* error) {
  return guarded(-1, error, [&] {
    auto* self = static_cast<Instance*>(instance);
    if (py::hasattr(self->own, "accept")) self->call("accept", *system, copied(solution, {6 * system->joints}));
    return 0;
  });
}

int accept_total(void* instance, int rod, int step, const double* total, char* error) {
  return guarded(-1, error, [&] {
    auto* self = static_cast<Instance*>(instance);
    if (!py::hasattr(self->own, "accept_total")) return 0;
    const py::ssize_t unknowns = py::len(self->rods[static_cast<std::size_t>(rod)].attr("compliance_per_j")) * 6;
    self->within([&] { return self->own.attr("accept_total")(rod, step, copied(total, {unknowns})); });
    return 0;
  });
}

int set_up(void* instance, const rodsweep_system* system, char* error) {
  return guarded(-1, error, [&] {
    auto* self = static_cast<Instance*>(instance);
    if (!py::hasattr(self->own, "set_up")) return 1;
    const py::object usable = self->call("set_up", *system);
    return usable.is_none() || py::bool_(usable) ? 1 : 0;
  });
}

int apply(void* instance, const double* r, double* z, char* error) {
  return guarded(-1, error, [&] {
    auto* self = static_cast<Instance*>(instance);
    const py::object returned = self->within([&] { return self->own.attr("apply")(copied(r, {6 * self->joints})); });
    read(returned, z, 6 * self->joints, "apply()");
    return 0;
  });
}

}  // namespace

const rodsweep_plugin_functions* rodsweep_plugin() {
  static const rodsweep_plugin_functions functions{
      RODSWEEP_PLUGIN_VERSION, create, destroy, propose, accept, accept_total, set_up, apply};
  return &functions;
}

void rodsweep_plugin_interrupt() { rodsweep::interrupt_call(); }
