// SPDX-License-Identifier: Apache-2.0
#include "cli/parser.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/suggestion.h"

namespace quintet::cli {
namespace {

// CLI11 keeps the arguments that it could not assign: an unknown option, or one argument too many.
void rejectRemaining(const CLI::App& app) {
  const std::vector<std::string> extras = app.remaining();
  if (extras.empty()) return;
  const auto option = std::ranges::find_if(extras, [](const std::string& e) { return e.size() > 1 && e[0] == '-'; });
  if (option == extras.end())
    throw UsageError(fmt::format("unexpected argument '{}'; see '{} --help'", extras.front(), app.get_name()));
  std::vector<std::string> names;
  for (const CLI::Option* known : app.get_options())
    for (const std::string& name : known->get_lnames()) names.push_back("--" + name);
  const std::string name = option->substr(0, option->find('='));
  throw UsageError(
      fmt::format("unknown option '{}'{}; see '{} --help'", name, suggestion(name, names), app.get_name()));
}

// `--spp "$N"` with an empty N is a mistake of the caller, not a request for the default.
void rejectEmptyValues(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options())
    if (option->nonpositional() && std::ranges::find(option->results(), "") != option->results().end())
      throw UsageError(fmt::format("{}: the value is empty", option->get_name()));
}

// CLI11 separates groups by two empty lines.
std::string withoutGaps(std::string text) {
  for (std::size_t at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n", at)) text.erase(at, 1);
  return text;
}

}  // namespace

void setUp(CLI::App& app, const std::string& examples) {
  app.footer("\nExamples:\n" + examples);
  app.get_formatter()->column_width(34);
  app.allow_extras();
  app.set_help_flag("-h,--help", "Print this help and exit");
}

bool parse(CLI::App& app, Arguments arguments) {
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    writeFile("-", withoutGaps(app.help()));
    return false;
  } catch (const CLI::ParseError& error) {
    rejectRemaining(app);
    throw UsageError(fmt::format("{}; see '{} --help'", error.what(), app.get_name()));
  }
  rejectRemaining(app);
  rejectEmptyValues(app);
  return true;
}

}  // namespace quintet::cli
