#include "runner/command/manual.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

namespace rodsweep {
namespace {

constexpr std::string_view codes_heading = "Exit codes:\n";

/// For troff: what it would take for a command of its own or would print as another character than can be typed.
std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '\\': safe += R"(\e)"; break;
      case '-': safe += R"(\-)"; break;
      case '\'': safe += R"(\(aq)"; break;
      case '`': safe += R"(\(ga)"; break;
      case '^': safe += R"(\(ha)"; break;
      case '~': safe += R"(\(ti)"; break;
      default: safe += c;
    }
  }
  return safe;
}

/// A line of its own, which may begin with a dot.
std::string line(std::string_view text) {
  return (!text.empty() && text[0] == '.' ? R"(\&)" : "") + escaped(text) + "\n";
}

std::string bold(std::string_view text) { return R"(\fB)" + escaped(text) + R"(\fR)"; }
std::string italic(std::string_view text) { return R"(\fI)" + escaped(text) + R"(\fR)"; }

/// Paragraphs, of which an empty line begins the first too; what is indented stays as it is, line by line.
std::string paragraphs(const std::string& text) {
  std::string page;
  std::istringstream lines(text);
  bool verbatim = false, begin = false;
  for (std::string words; std::getline(lines, words);) {
    const bool indented = words.rfind("  ", 0) == 0;
    if (indented != verbatim) {
      begin = begin || !page.empty();
      page += indented ? "" : ".EE\n";
    }
    if (words.empty()) {
      begin = true;
    } else {
      page += begin ? ".PP\n" : "";
      page += indented && !verbatim ? ".EX\n" : "";
      page += line(words);
      begin = false;
    }
    verbatim = indented;
  }
  return page + (verbatim ? ".EE\n" : "");
}

/// "-o FILE, --output FILE", "--watch [SECONDS]"
std::string entry(const ArgumentOutline& argument) {
  if (argument.names.empty()) return italic(argument.value) + (argument.repeated ? "..." : "");
  std::string text;
  for (const std::string& name : argument.names) text += (text.empty() ? "" : ", ") + bold(name);
  if (argument.value.empty()) return text;
  return text + " " + (argument.optional_value ? "[" + italic(argument.value) + "]" : italic(argument.value));
}

/// Arguments, then options.
std::string entries(const CommandOutline& command) {
  std::string page;
  for (const auto* list : {&command.arguments, &command.options})
    for (const ArgumentOutline& argument : *list) page += ".TP\n" + entry(argument) + "\n" + line(argument.description);
  return page;
}

/// "rodsweep run [OPTION]... JOB"
std::string usage(const std::string& program, const CommandOutline& command) {
  std::string text = bold(program + " " + command.name);
  if (!command.options.empty()) text += " [" + italic("OPTION") + "]...";
  for (const ArgumentOutline& argument : command.arguments)
    text += " " + (argument.required ? entry(argument) : "[" + entry(argument) + "]");
  if (!command.commands.empty()) {
    text += " ";
    for (const CommandOutline& inner : command.commands)
      text += (&inner == &command.commands.front() ? "" : "|") + bold(inner.name);
  }
  return text + "\n";
}

bool is_help(const ArgumentOutline& option) { return !option.names.empty() && option.names.back() == "--help"; }

/// A footer before its exit codes, and these.
struct Footer {
  explicit Footer(const std::string& text)
      : about(text.substr(0, text.rfind(codes_heading))),
        codes(about.size() == text.size() ? "" : text.substr(about.size() + codes_heading.size())) {}

  std::string about, codes;
};

}  // namespace

std::string manual_page(const CommandOutline& program, const std::string& title) {
  const std::size_t colon = program.description.find(": "), end = program.description.find('\n');
  const Footer footer(program.footer);
  std::string page = fmt::format(".TH RODSWEEP 1 \"\" \"{}\" \"User commands\"\n.SH NAME\n{} \\- {}", title,
                                 program.name, line(program.description.substr(colon + 2, end - colon - 2)));
  std::string usages, sections;
  for (CommandOutline command : program.commands) {
    auto& options = command.options;  // --help is said once
    options.erase(std::remove_if(options.begin(), options.end(), is_help), options.end());
    const Footer own(command.footer);
    const std::string use = usage(program.name, command);
    usages += (usages.empty() ? "" : ".br\n") + use;
    sections += ".SS " + command.name + "\n" + use + paragraphs("\n" + command.description + ".") + entries(command) +
                paragraphs("\n" + own.about);
    if (!own.codes.empty() && own.codes != footer.codes) sections += paragraphs("\nExit codes:\n" + own.codes);
  }
  page += ".SH SYNOPSIS\n" + usages;
  page += ".SH DESCRIPTION\n" + paragraphs(program.description.substr(end + 1) + "\n\n" + footer.about);
  page += ".SH OPTIONS\n" + entries(program);
  page += ".SH COMMANDS\n" + sections;
  page += ".SH EXIT STATUS\n" + paragraphs(footer.codes);
  return page + ".SH SEE ALSO\n.BR mpirun (1),\n.BR h5dump (1)\n";
}

}  // namespace rodsweep
