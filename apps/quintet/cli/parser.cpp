// SPDX-License-Identifier: Apache-2.0
#include "cli/parser.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/parse.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "cli/help_text.h"
#include "cli/values.h"

namespace quintet::cli {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

[[noreturn]] void fail(const OptionTable& table, const std::string& problem) {
  throw UsageError(fmt::format("{}; see '{} --help'", problem, table.program()));
}

// An option of the table and what the parser collected for it.
struct Parsed {
  Option option;
  CLI::Option* results = nullptr;
};

// Values are collected as text. The table reports what is wrong with them.
CLI::Option* declare(CLI::App& app, const Option& option) {
  if (option.isFlag()) return app.add_flag(option.names)->disable_flag_override();
  if (!option.withoutValue.empty())
    return app.add_flag(fmt::format("{}{{{}}}", option.names, option.withoutValue))
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  CLI::Option* result = app.add_option(option.names);
  result->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (option.isArgument() && option.isList())
    result->expected(1, -1)->allow_extra_args(true);
  else
    result->expected(1)->allow_extra_args(false);
  return result;
}

// The arguments that could not be assigned: an unknown option, or one argument too many.
void rejectRemaining(const OptionTable& table, const CLI::App& app) {
  const std::vector<std::string> extras = app.remaining();
  const auto end = std::ranges::find(extras, "--");  // marks the end of options, is no argument itself
  for (const std::string& extra : std::span(extras.begin(), end)) {
    if (extra.size() < 2 || extra[0] != '-') continue;
    std::vector<std::string> names;
    for (const Option& known : table.options()) std::ranges::move(known.nameList(), std::back_inserter(names));
    std::erase_if(names, [](const std::string& name) { return !name.starts_with("--"); });
    const std::string name = extra.substr(0, extra.find('='));
    fail(table, fmt::format("unknown option '{}'{}", printable(name), suggestion(name, names)));
  }
  for (auto extra = extras.begin(); extra != extras.end(); ++extra)
    if (extra != end) fail(table, fmt::format("unexpected argument '{}'", printable(*extra)));
}

// Reports an error of the parser. Its text starts with the name of the option.
[[noreturn]] void reportError(const std::string& text, const OptionTable& table, const std::vector<Parsed>& parsed) {
  for (const Parsed& p : parsed) {
    std::string name = p.results->get_name();
    name.erase(0, name.find_first_not_of('-'));
    const std::size_t at = text.find_first_not_of('-');
    if (text.compare(at, name.size() + 1, name + ":") != 0 && text.compare(at, name.size() + 1, name + " ") != 0)
      continue;
    if (p.option.isFlag()) fail(table, fmt::format("{}: this option takes no value", p.option.longName()));
    fail(table, fmt::format("{}: the value {} is missing", p.option.longName(), p.option.value));
  }
  fail(table, text);
}

[[noreturn]] void failEmpty(const std::string& name) { throw UsageError(fmt::format("{}: the value is empty", name)); }

// The parser would use the next argument as the value of "--spp=".
void rejectEmptyAssignments(const OptionTable& table, Arguments arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    if (!argument.starts_with("--") || !argument.ends_with('=')) continue;
    for (const Option& option : table.options())
      if (option.longName() + "=" == argument) failEmpty(option.longName());
  }
}

void assign(const Parsed& parsed) {
  const Option& option = parsed.option;
  std::vector<std::string> values = parsed.results->results();
  const std::string name = option.isArgument() ? option.names : option.longName();
  if (values.empty()) return;
  if (!option.isList()) values = {values.back()};  // a script can append an option to replace its own
  // `--spp "$N"` with an empty N is a mistake of the caller, not a request for the default.
  if (!option.isArgument() && std::ranges::find(values, "") != values.end()) failEmpty(name);
  if (option.delimiter != 0) {
    std::vector<std::string> parts;
    for (const std::string& value : values)
      std::ranges::move(splitText(value, option.delimiter), std::back_inserter(parts));
    values = std::move(parts);
  }
  std::visit(
      Overloaded{[](std::monostate) {}, [](bool* target) { *target = true; },
                 [&](int* target) {
                   const std::optional<double> number = parseReal(name, values.front(), option.min, option.max);
                   if (*number != static_cast<int>(*number))
                     throw UsageError(fmt::format("{}: '{}' is not an integer", name, values.front()));
                   *target = static_cast<int>(*number);
                 },
                 [&](std::vector<std::string>* target) { *target = values; },
                 [&](std::vector<std::filesystem::path>* target) { target->assign(values.begin(), values.end()); },
                 [&](auto* target) { *target = values.front(); }},
      option.target);
}

}  // namespace

bool parse(const OptionTable& table, Arguments arguments) {
  CLI::App app(table.description(), table.program());
  app.allow_extras();
  app.set_help_flag("");
  std::vector<Parsed> parsed;
  for (const Option& option : table.arguments()) parsed.push_back({option, declare(app, option)});
  bool help = false;
  for (Option& option : table.options()) {
    if (option.names == "-h,--help") option.target = table.redirectedHelp() ? table.redirectedHelp() : &help;
    CLI::Option* results = declare(app, option);
    parsed.push_back({std::move(option), results});
  }
  rejectEmptyAssignments(table, arguments);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError& error) {
    rejectRemaining(table, app);
    reportError(error.what(), table, parsed);
  }
  if (!table.redirectedHelp() && app.count("--help") > 0) {
    writeFile("-", helpText(table, helpWidth()));
    return false;
  }
  rejectRemaining(table, app);
  for (const Parsed& p : parsed) assign(p);
  return true;
}

}  // namespace quintet::cli
