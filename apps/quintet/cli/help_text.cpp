// SPDX-License-Identifier: Apache-2.0
#include "cli/help_text.h"

#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/wrap.h"
#include "cli/terminal.h"

namespace quintet::cli {
namespace {

constexpr std::size_t kMinWidth = 40, kFileWidth = 80, kMaxWidth = 100;  // columns
constexpr std::size_t kHelpColumn = 28;

// "  -o, --output FILE         Output file: …". A long name has a line of its own.
std::string optionText(const Option& option, std::size_t width) {
  const std::string left = fmt::format("  {}{}", fmt::join(option.nameList(), ", "), option.valueForm());
  return twoColumns(left, option.help, kHelpColumn, width);
}

}  // namespace

std::size_t helpWidth() {
  const std::optional<std::size_t> width = terminalWidth(STDOUT_FILENO);
  return width ? std::clamp(*width, kMinWidth, kMaxWidth) : kFileWidth;
}

std::string examplesText(const std::vector<Example>& examples, std::size_t width) {
  std::size_t column = 0;
  for (const Example& example : examples)
    if (!example.text.empty()) column = std::max(column, 2 + columnsOf(example.command) + 2);
  const bool beside = std::ranges::all_of(
      examples, [&](const Example& e) { return e.text.empty() || column + columnsOf(e.text) <= width; });
  std::string text;
  for (const Example& example : examples) {
    const std::string line = "  " + example.command;
    if (example.text.empty())
      text += line + "\n";
    else if (beside)
      text += padded(line, column) + example.text + "\n";
    else
      text += line + "\n      " + wrapped(example.text, width, 6, 6) + "\n";
  }
  return text;
}

std::string helpText(const OptionTable& table, std::size_t width) {
  std::string text = wrapped(table.description(), width, 0) + "\n\nUsage: " + table.usage() + "\n";
  if (!table.arguments().empty()) text += "\nArguments:\n";
  for (const Option& argument : table.arguments()) text += optionText(argument, width);
  for (const OptionGroup& group : table.groups()) {
    text += fmt::format("\n{}:\n", group.name);
    for (const Option& option : group.options) text += optionText(option, width);
  }
  if (!table.examples().empty()) text += "\nExamples:\n" + examplesText(table.examples(), width);
  return text;
}

}  // namespace quintet::cli
