// SPDX-License-Identifier: Apache-2.0
#include "commands/completion.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/command.h"
#include "cli/option_table.h"

namespace quintet::cli {
namespace {

// Returns the text with a backslash before each of the characters.
std::string escaped(std::string_view text, std::string_view characters) {
  std::string result;
  for (const char c : text) {
    if (characters.find(c) != characters.npos) result += '\\';
    result += c;
  }
  return result;
}

// Returns the text for single quotes of bash and zsh.
std::string inQuotes(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result;
}

// Returns the help without details.
std::string brief(const std::string& help) { return help.substr(0, std::min(help.find(" ("), help.find(';'))); }

bool wantsFiles(const Candidates& candidates) { return candidates.folders || !candidates.extensions.empty(); }

// --- bash -----------------------------------------------------------------------------------------------------------

constexpr std::string_view kBashStart = R"bash(# SPDX-License-Identifier: Apache-2.0
# Completion of quintet for bash. Made by 'quintet help --completion bash'.

# Adds the words of $1 that start with $2.
_quintet_words() {
  local word
  while IFS= read -r word; do
    [[ -n $word ]] && COMPREPLY+=("$word")
  done < <(compgen -W "$1" -- "$2")
}

# Adds folders, and files with one of the extensions $1 (separated by |), that start with $2.
_quintet_files() {
  local file
  compopt -o filenames 2> /dev/null
  while IFS= read -r file; do
    if [[ -d $file ]] || [[ -n $1 && $file =~ \.($1)$ ]]; then COMPREPLY+=("$file"); fi
  done < <(compgen -f -- "$2")
}

_quintet() {
  local current=${COMP_WORDS[COMP_CWORD]} previous='' command='' options='' assigned='' end='' i groups='GROUPS'
  ((COMP_CWORD > 0)) && previous=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  # bash splits "--name=value" at the sign.
  if [[ $current == = ]]; then
    current='' assigned=yes
  elif [[ $previous == = ]] && ((COMP_CWORD > 1)); then
    previous=${COMP_WORDS[COMP_CWORD - 2]} assigned=yes
  fi
  ((COMP_CWORD > 1)) && command=${COMP_WORDS[1]}
  ((COMP_CWORD > 2)) && [[ " $groups " == *" $command "* ]] && command+=-${COMP_WORDS[2]}
  for ((i = 2; i < COMP_CWORD; ++i)); do
    [[ ${COMP_WORDS[i]} == -- ]] && end=yes
  done
  case $command in
)bash";

std::string bashCandidates(const Candidates& candidates) {
  std::string text;
  if (!candidates.names.empty())
    text +=
        fmt::format("_quintet_words '{}' \"$current\"", inQuotes(fmt::format("{}", fmt::join(candidates.names, " "))));
  if (wantsFiles(candidates))
    text += fmt::format("{}_quintet_files '{}' \"$current\"", text.empty() ? "" : "; ",
                        escaped(fmt::format("{}", fmt::join(candidates.extensions, "|")), "."));
  return text;
}

std::string bashCase(const OptionTable& table) {
  std::string text = fmt::format("    {})\n", commandKey(table.command()));
  std::vector<std::string> names;
  std::string values;
  for (const Option& option : table.options()) {
    std::ranges::move(option.nameList(), std::back_inserter(names));
    if (option.isFlag()) continue;
    std::string action = bashCandidates(option.candidates);
    action += action.empty() ? "return" : "; return";
    if (!option.withoutValue.empty()) action = "if [[ -n $assigned ]]; then " + action + "; fi";
    values += fmt::format("          {}) {} ;;\n", fmt::join(option.nameList(), " | "), action);
  }
  if (!values.empty())
    text += "      if [[ -z $end ]]; then\n        case $previous in\n" + values + "        esac\n      fi\n";
  text += fmt::format("      options='{}'\n", fmt::join(names, " "));
  std::string arguments;  // the position of an argument is not considered
  for (const Option& argument : table.arguments()) {
    const std::string action = bashCandidates(argument.candidates);
    if (!action.empty() && arguments.find(action) == arguments.npos) arguments += "        " + action + "\n";
  }
  if (!arguments.empty()) text += "      if [[ -n $end || $current != -* ]]; then\n" + arguments + "      fi\n";
  return text + "      ;;\n";
}

// --- zsh ------------------------------------------------------------------------------------------------------------

std::string zshAction(const Candidates& candidates) {
  const std::string names = fmt::format("{}", fmt::join(candidates.names, " "));
  const std::string files = candidates.extensions.empty()
                                ? "_files -/"
                                : fmt::format("_files -g \"*.({})\"", fmt::join(candidates.extensions, "|"));
  if (!wantsFiles(candidates)) return names.empty() ? " " : "(" + names + ")";
  return names.empty() ? files : fmt::format("{{compadd -- {}; {}}}", names, files);
}

std::string zshOption(const Option& option) {
  const std::string help = escaped(brief(option.help), "[]:\\");
  const std::string value = option.isFlag() ? ""
                                            : fmt::format("{}:{}:{}", option.withoutValue.empty() ? "" : ":",
                                                          escaped(option.value, ":\\"), zshAction(option.candidates));
  const std::vector<std::string> names = option.nameList();
  std::string text;
  for (const std::string& name : names) {
    const std::string exclusive = option.isList()    ? "*"
                                  : names.size() > 1 ? fmt::format("({})", fmt::join(names, " "))
                                                     : "";
    // "=-": the value, if there is one, follows the sign.
    const char* sign = option.isFlag() ? "" : !option.withoutValue.empty() ? "=-" : name.starts_with("--") ? "=" : "+";
    text += fmt::format("    '{}' \\\n", inQuotes(fmt::format("{}{}{}[{}]{}", exclusive, name, sign, help, value)));
  }
  return text;
}

std::string zshFunction(const OptionTable& table) {
  std::string text = fmt::format("_quintet_{}() {{\n  _arguments -s -S \\\n", commandKey(table.command()));
  for (const Option& option : table.options()) text += zshOption(option);
  for (const Option& argument : table.arguments())
    text += fmt::format("    '{}:{}:{}' \\\n",
                        argument.isList()   ? "*"
                        : argument.required ? ""
                                            : ":",
                        argument.names, inQuotes(zshAction(argument.candidates)));
  return text.substr(0, text.size() - 3) + "\n}\n\n";
}

// --- fish -----------------------------------------------------------------------------------------------------------

std::string fishText(std::string_view text) { return "'" + escaped(text, "'\\") + "'"; }

std::string fishCandidates(const Candidates& candidates) {
  std::string text = fmt::format("{}", fmt::join(candidates.names, " "));
  if (!candidates.extensions.empty())
    text += fmt::format("{}(for end in .{}; __fish_complete_suffix $end; end)", text.empty() ? "" : " ",
                        fmt::join(candidates.extensions, " ."));
  else if (candidates.folders)
    text += "(__fish_complete_directories)";
  return text;
}

std::string fishOption(const OptionTable& table, const Option& option) {
  std::string words = table.command();  // "farm plan": both words are on the line
  if (const std::size_t space = words.find(' '); space != words.npos)
    words.replace(space, 1, "; and __fish_seen_subcommand_from ");
  std::string text = fmt::format("complete -c quintet -n '__fish_seen_subcommand_from {}'", words);
  if (!option.isArgument())
    for (const std::string& name : option.nameList())
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  const std::string candidates = fishCandidates(option.candidates);
  if (!option.isArgument() && !option.isFlag() && option.withoutValue.empty()) text += " -x";
  if (!candidates.empty()) text += " -a " + fishText(candidates);
  if (!option.isArgument()) text += " -d " + fishText(brief(option.help));
  return option.isArgument() && candidates.empty() ? "" : text + "\n";
}

}  // namespace

std::string bashCompletion() {
  std::string text(kBashStart);
  const std::vector<std::string> names = commandWords(), groups = commandGroups();
  text.replace(text.find("GROUPS"), 6, fmt::format("{}", fmt::join(groups, " ")));
  for (const Command& command : commands()) text += bashCase(command.options());
  for (const std::string& group : groups)
    text += fmt::format("    {})\n      _quintet_words '{}' \"$current\"\n      ;;\n", group,
                        fmt::join(commandWords(group), " "));
  return text + fmt::format(
                    "    *) options='--help --version' ;;\n  esac\n"
                    "  if [[ -z $end && $current == -* ]]; then _quintet_words \"$options\" \"$current\"; fi\n"
                    "  if ((COMP_CWORD == 1)) && [[ $current != -* ]]; then\n"
                    "    _quintet_words '{}' \"$current\"\n  fi\n}}\n\ncomplete -F _quintet quintet\n",
                    fmt::join(names, " "));
}

std::string zshCompletion() {
  std::string text =
      "#compdef quintet\n# SPDX-License-Identifier: Apache-2.0\n# Completion of quintet for zsh. Made by 'quintet help "
      "--completion zsh'.\n\n";
  std::string list;
  for (const Command& command : commands()) {
    text += zshFunction(command.options());
    if (command.name.find(' ') == command.name.npos)
      list += fmt::format("    '{}:{}'\n", command.name, inQuotes(command.summary));
  }
  std::string groups;
  for (const std::string& group : commandGroups()) {
    list += fmt::format("    '{}:{}'\n", group, "commands of a group");
    groups += fmt::format(
        "  if [[ $command == {0} ]]; then\n    if ((CURRENT == 2)); then\n      compadd -- {1}\n      return\n    fi\n"
        "    command={0}-$words[2]\n    shift words\n    ((CURRENT--))\n  fi\n",
        group, fmt::join(commandWords(group), " "));
  }
  return text + "_quintet() {\n  local -a names\n  names=(\n" + list +
         "  )\n"
         "  if ((CURRENT == 2)); then\n    _describe command names\n    return\n  fi\n"
         "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n" +
         groups +
         "  ((${+functions[_quintet_$command]})) && _quintet_$command\n}\n\n"
         "if [[ $funcstack[1] == _quintet ]]; then _quintet \"$@\"; else compdef _quintet quintet; fi\n";
}

std::string fishCompletion() {
  std::string text =
      "# SPDX-License-Identifier: Apache-2.0\n# Completion of quintet for fish. Made by 'quintet help --completion "
      "fish'.\ncomplete -c quintet -f\n"
      "complete -c quintet -n __fish_use_subcommand -l help -s h -d 'Print the commands'\n"
      "complete -c quintet -n __fish_use_subcommand -l version -d 'Print the version'\n";
  for (const Command& command : commands())
    if (const std::size_t space = command.name.find(' '); space == command.name.npos)
      text += fmt::format("complete -c quintet -n __fish_use_subcommand -a {} -d {}\n", command.name,
                          fishText(command.summary));
    else
      text += fmt::format("complete -c quintet -n '__fish_seen_subcommand_from {}' -a {} -d {}\n",
                          command.name.substr(0, space), command.name.substr(space + 1), fishText(command.summary));
  for (const std::string& group : commandGroups())
    text += fmt::format("complete -c quintet -n __fish_use_subcommand -a {}\n", group);
  for (const Command& command : commands()) {
    const OptionTable table = command.options();
    for (const Option& option : table.options()) text += fishOption(table, option);
    for (const Option& argument : table.arguments()) text += fishOption(table, argument);
  }
  return text;
}

}  // namespace quintet::cli
