// What a user's code does to the process stays with it, and it is interrupted when its result is no longer wanted: in
// every function that the program calls, and in every way in which a person may do it in Python.
#include <unistd.h>

#include <cfenv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solver/plugin/plugin.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::every_user_function {

namespace fs = std::filesystem;

/// What the program calls, by the names in a traceback.
const std::vector<std::string> functions{"<module>",     "__init__", "propose", "accept",
                                         "accept_total", "set_up",   "apply",   "__del__"};

fs::path temporary(const std::string& name) {
  return fs::temp_directory_path() / ("user_function_" + std::to_string(getpid()) + name);
}

/// Classes whose function `name` does `deed`.
std::string code(const std::string& name, const std::string& deed) {
  return "import ctypes, os, time\n"
         "def now(name):\n    if name == '" +
         name + "':\n        " + deed + "\nnow('<module>')\n" + R"(
class Guess:
    def __init__(self, rods, options): now('__init__')
    def __del__(self): now('__del__')
    def propose(self, system): now('propose')
    def accept(self, system, x): now('accept')
    def accept_total(self, rod, step, x): now('accept_total')
class Preconditioner:
    def __init__(self, rods, options): now('__init__')
    def __del__(self): now('__del__')
    def set_up(self, system): now('set_up')
    def apply(self, r):
        now('apply')
        return r
)";
}

/// Runs everything in a file with this code, and `after` after each call.
void run(const std::string& text, const std::function<void()>& after) {
  static int files = 0;
  const fs::path path = temporary('_' + std::to_string(files++) + ".py");
  std::ofstream(path) << text;
  const auto source = [&](const char* kind) {
    return PluginSource{PYTHON_PLUGIN, std::string(kind) + '\n' + path.native() + "\n0\n", path.filename().native()};
  };
  const test::OneRod one;
  VectorX x = one.system.rhs(), z = x;
  {
    PluginGuess guess(source("Guess"), one.scene);
    after();
    guess.propose(one.system, {0, 0, 0}, x);
    after();
    guess.accept(one.system, {0, 0, 0}, x);
    after();
    guess.accept_total(0, 0, x);
    after();
    PluginPreconditioner preconditioner(source("Preconditioner"), one.scene.rods[0], 0, one.system);
    after();
    preconditioner.set_up(one.system.matrix());
    after();
    preconditioner.apply(x.data(), z.data());
    after();
  }
  after();
  fs::remove(path);
}

TEST_CASE("every function of a user may change folder and rounding, and the program keeps its own") {
  const fs::path folder = fs::current_path();
  const std::vector<std::string> deeds{"os.chdir('/')", "os.fchdir(os.open('/', os.O_RDONLY))",
                                       "assert ctypes.CDLL(None).fesetround(" + std::to_string(FE_UPWARD) + ") == 0"};
  for (const std::string& function : functions)
    for (const std::string& deed : deeds) {
      INFO(function << ": " << deed);
      run(code(function, deed), [&] {
        REQUIRE(fs::current_path() == folder);
        REQUIRE(std::fegetround() == FE_TONEAREST);
      });
    }
}

TEST_CASE("every function of a user is interrupted where it is, once its result is no longer wanted") {
  const fs::path begun = temporary("_begun");
  handle_calls({nullptr, std::abort});
  for (const std::string& function : functions)
    for (const char* endless : {"while True: pass", "time.sleep(1000)"}) {
      INFO(function << ": " << endless);
      fs::remove(begun);
      std::optional<std::string> where;
      const Interruptible interruptible([&] { return fs::exists(begun); });
      try {
        run(code(function, "open('" + begun.native() + "', 'w').close()\n        " + endless), [] {});
      } catch (const InterruptedComputation& interrupted) {
        where = interrupted.where();
      }
      CHECK(fs::exists(begun));
      if (function == "__del__") continue;  // nothing may be thrown while an object ends
      REQUIRE(where);
      CHECK_THAT(*where, Catch::Matchers::ContainsSubstring(" in " + function));
    }
  fs::remove(begun);
  handle_calls({});
}

}  // namespace rodsweep::every_user_function
