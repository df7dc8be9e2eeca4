#include "runner/command/completion.hpp"

#include <fmt/format.h>

#include <map>

namespace rodsweep {
namespace {

/// What a word of the command line may be.
enum class Words { unknown, job, results, file, command };

Words words_of(const ArgumentOutline& argument) {
  if (argument.value == "JOB") return Words::job;
  if (argument.value == "FILE" || argument.value == "OLD") return Words::results;
  if (argument.value == "HOSTS") return Words::file;
  if (argument.value == "COMMAND") return Words::command;
  return Words::unknown;
}

/// Of the argument that a command's places are for: those behind the first are conditions and numbers.
Words first_words(const CommandOutline& command) {
  return command.arguments.empty() ? Words::unknown : words_of(command.arguments.front());
}

/// "*.json"; empty: of no files.
std::string pattern(Words words) {
  switch (words) {
    case Words::job: return "*.json";
    case Words::results: return "*.h5";
    case Words::file: return "*";
    default: return "";
  }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string zsh_quoted(const std::string& text) { return "'" + replaced(text, "'", R"('\'')") + "'"; }

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, R"(\)", R"(\\)"), "'", R"(\')") + "'";
}

/// "bash zsh --help"
std::string bash_words(const CommandOutline& command) {
  std::string text;
  for (const CommandOutline& inner : command.commands) text += inner.name + " ";
  for (const ArgumentOutline& option : command.options)
    if (!option.names.empty()) text += option.names.back() + " ";
  if (!text.empty()) text.pop_back();
  return text;
}

/// Arms of a case of the word before: what the values of options are, " -o|--output) words= pattern='*.h5' ;;".
std::string bash_values(const CommandOutline& command) {
  std::map<std::string, std::string> names;  // by pattern
  for (const ArgumentOutline& option : command.options)
    if (!option.value.empty() && !option.optional_value)
      names[pattern(words_of(option))] += fmt::format("|{}", fmt::join(option.names, "|"));
  std::string arms;
  for (const auto& [files, options] : names)
    arms += fmt::format(" {}) words= pattern='{}' ;;", options.substr(1), files);
  return arms;
}

/// An arm's part of a command that takes another: bash's own completion of that, where it is loaded, or any file.
constexpr const char* bash_command_behind =
    "        for ((behind = 2; behind < COMP_CWORD; ++behind)); do\n"
    "          [[ ${COMP_WORDS[behind]} == -- ]] || continue\n"
    "          if declare -F _command_offset >/dev/null; then _command_offset $((behind + 1)); return; fi\n"
    "          words= pattern='*'\n"
    "        done\n";

/// Arguments of zsh's _arguments: "'(-o --output)'{-o+,--output=}'[What it is]:FILE:_files -g \"*.h5\"'".
std::string zsh_option(const ArgumentOutline& option) {
  const bool value = !option.value.empty();
  const std::string mark = option.repeated ? "*" : "";
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ",") + name + (value ? (name[1] == '-' ? "=" : "+") : "");
  std::string text = "[" + replaced(replaced(option.description, "[", R"(\[)"), "]", R"(\])") + "]";
  if (value) {
    const std::string files = pattern(words_of(option));
    text += std::string(option.optional_value ? "::" : ":") + option.value + ":" +
            (files.empty() ? " " : fmt::format("_files -g \"{}\"", files));
  }
  if (option.names.size() == 1) return zsh_quoted(mark + names + text);
  return fmt::format("'({})'{{{}}}{}", fmt::join(option.names, " "), names, zsh_quoted(text));
}

std::string zsh_argument(const ArgumentOutline& argument) {
  const Words words = words_of(argument);
  if (words == Words::command) return "'(-)*:: :{ [[ $words[1] != -- ]] || { shift words; ((--CURRENT)) }; _normal }'";
  const std::string files = pattern(words);
  return zsh_quoted(fmt::format("{}:{}:{}", argument.repeated ? "*" : "", argument.value,
                                files.empty() ? " " : fmt::format("_files -g \"{}\"", files)));
}

/// The list of commands for zsh's _describe.
std::string zsh_commands(const CommandOutline& command) {
  std::string text;
  for (const CommandOutline& inner : command.commands) text += " " + zsh_quoted(inner.name + ":" + inner.description);
  return text;
}

std::string zsh_case(const CommandOutline& command) {
  std::string text = fmt::format("        {}) ", command.name);
  if (!command.commands.empty())
    return text + fmt::format("names=({}); _describe -t commands {} names ;;\n", zsh_commands(command),
                              zsh_quoted(command.name));
  text += "_arguments -S";
  for (const ArgumentOutline& option : command.options) text += " \\\n          " + zsh_option(option);
  for (const ArgumentOutline& argument : command.arguments) text += " \\\n          " + zsh_argument(argument);
  return text + " ;;\n";
}

std::string fish_files(Words words) {
  const std::string files = pattern(words);
  if (files.empty()) return "";
  if (words == Words::file) return " -F";  // any, in place of those that the first line turned off
  return fmt::format(" -k -a '(__fish_complete_suffix {})'", files.substr(1));
}

/// Lines of fish's complete, for what comes behind a command, or behind the program itself.
std::string fish_lines(const CommandOutline& command, const std::string& begin) {
  std::string lines;
  for (const CommandOutline& inner : command.commands)
    lines += fmt::format("{} -a {} -d {}\n", begin, inner.name, fish_quoted(inner.description));
  for (const ArgumentOutline& option : command.options) {
    lines += begin;
    for (const std::string& name : option.names)
      lines += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.value.empty() && !option.optional_value)
      lines += (words_of(option) == Words::file ? " -r" : " -x") + fish_files(words_of(option));
    lines += " -d " + fish_quoted(option.description) + "\n";
  }
  const Words words = first_words(command);
  if (words == Words::command) lines += begin + " -a '(__rodsweep_command_behind)'\n";
  if (!pattern(words).empty()) lines += begin + fish_files(words) + "\n";
  return lines;
}

}  // namespace

std::string bash_completion(const CommandOutline& program) {
  std::string cases;
  for (const CommandOutline& command : program.commands) {
    cases += fmt::format("      {}) words='{}' pattern='{}'\n", command.name, bash_words(command),
                         pattern(first_words(command)));
    if (const std::string values = bash_values(command); !values.empty())
      cases += "        case $before in" + values + " esac\n";
    if (first_words(command) == Words::command) cases += bash_command_behind;
    cases += "        ;;\n";
  }
  return fmt::format(R"(_rodsweep() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words= pattern= behind
  if ((COMP_CWORD == 1)); then
    words='{}'
  else
    case ${{COMP_WORDS[1]}} in
{}    esac
  fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  if [[ -n $pattern && $word != -* ]]; then
    local file
    while IFS= read -r file; do COMPREPLY+=("$file"); done \
      < <(compgen -f -X "!$pattern" -- "$word"; compgen -d -- "$word")
  fi
}}
complete -o filenames -F _rodsweep {}
)",
                     bash_words(program), cases, program.name);
}

std::string zsh_completion(const CommandOutline& program) {
  std::string options, cases;
  for (const ArgumentOutline& option : program.options) options += " " + zsh_option(option);
  for (const CommandOutline& command : program.commands) cases += zsh_case(command);
  return fmt::format(R"(#compdef {0}
compdef _rodsweep {0}

_rodsweep() {{
  local curcontext=$curcontext context state state_descr
  local -a line names
  local -A opt_args
  _arguments -C{1} '1: :->command' '*:: :->words' && return
  case $state in
    command)
      names=({2})
      _describe -t commands command names ;;
    words)
      curcontext="${{curcontext%:*:*}}:{0}-$line[1]:"
      case $line[1] in
{3}      esac ;;
  esac
}}

if [[ $funcstack[1] == _rodsweep ]]; then _rodsweep "$@"; fi  # autoloaded, not sourced
)",
                     program.name, options, zsh_commands(program), cases);
}

std::string fish_completion(const CommandOutline& program) {
  std::string lines = fish_lines(program, fmt::format("complete -c {} -n __rodsweep_no_command", program.name));
  for (const CommandOutline& command : program.commands)
    lines += fish_lines(command, fmt::format("complete -c {} -n '__rodsweep_command {}'", program.name, command.name));
  return fmt::format(R"(function __rodsweep_no_command
  test (count (commandline -opc)) -eq 1
end

function __rodsweep_command
  set -l words (commandline -opc)
  test (count $words) -gt 1; and test $words[2] = $argv[1]
end

function __rodsweep_command_behind
  set -l words (commandline -opc) (commandline -ct)
  set -l at (contains -i -- -- $words); or return
  set -e words[1..$at]
  complete -C "$words"
end

complete -c {} -f
{})",
                     program.name, lines);
}

}  // namespace rodsweep
