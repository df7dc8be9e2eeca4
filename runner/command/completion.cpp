#include "runner/command/completion.hpp"

#include <fmt/format.h>

namespace rodsweep {
namespace {

/// "--json --help", and commands of its own.
std::string words(const CLI::App& command) {
  std::string text;
  for (const CLI::App* inner : command.get_subcommands({})) text += inner->get_name() + " ";
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) text += "--" + name + " ";
  if (!text.empty()) text.pop_back();
  return text;
}

/// Endings of the files that it reads: positional JOB and FILE.
std::string endings(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_name(true) == "JOB") return "json";
    if (option->get_name(true) == "FILE") return "h5";
  }
  return "";
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string cases;
  for (const CLI::App* command : app.get_subcommands({}))
    cases +=
        fmt::format("    {}) words=\"{}\"; ending={} ;;\n", command->get_name(), words(*command), endings(*command));
  return fmt::format(R"(_rodsweep() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words ending=
  case ${{COMP_WORDS[1]}} in
{}    *) words="{}" ;;
  esac
  if ((COMP_CWORD == 1)); then words="{}"; ending=; fi
  if [[ $before == -o || $before == --output ]]; then words=; ending=h5; fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  if [[ -n $ending && $word != -* ]]; then
    local file
    while IFS= read -r file; do COMPREPLY+=("$file"); done \
      < <(compgen -f -X "!*.$ending" -- "$word"; compgen -d -- "$word")
  fi
}}
complete -o filenames -F _rodsweep {}
)",
                     cases, words(app), words(app), app.get_name());
}

}  // namespace rodsweep
