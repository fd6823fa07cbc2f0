// SPDX-License-Identifier: Apache-2.0
#include "cli/option_table.h"

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

constexpr const char* kOptions = "Options";

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
  if (!option.isList() && !option.isFlag() && values.size() > 1)
    throw UsageError(fmt::format("{}: given {} times, but it has one value", name, values.size()));
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

bool Option::isList() const {
  return std::holds_alternative<std::vector<std::string>*>(target) ||
         std::holds_alternative<std::vector<std::filesystem::path>*>(target);
}

std::vector<std::string> Option::nameList() const { return splitText(names, ','); }

std::string Option::longName() const { return nameList().back(); }

OptionTable::OptionTable(std::string command, std::string description)
    : command_(std::move(command)), description_(std::move(description)) {
  add({{.names = "-h,--help", .help = "Print this help and exit"}});
}

void OptionTable::add(const std::string& group, std::vector<Option> options) {
  for (Option& option : options) {
    if (option.isArgument()) {
      arguments_.push_back(std::move(option));
      continue;
    }
    auto found = std::ranges::find(groups_, group, &OptionGroup::name);
    if (found == groups_.end()) found = groups_.insert(groups_.end(), {group, {}});
    found->options.push_back(std::move(option));
  }
}

void OptionTable::add(std::vector<Option> options) { add(kOptions, std::move(options)); }

void OptionTable::addExamples(std::vector<Example> examples) {
  std::ranges::move(examples, std::back_inserter(examples_));
}

std::vector<Option> OptionTable::options() const {
  std::vector<Option> all;
  for (const OptionGroup& group : groups_) all.insert(all.end(), group.options.begin(), group.options.end());
  return all;
}

std::string OptionTable::usage() const {
  std::string text = program() + " [OPTIONS]";
  for (const Option& argument : arguments_) {
    const std::string form = argument.names + (argument.isList() ? "..." : "");
    text += argument.required ? " " + form : " [" + form + "]";
  }
  return text;
}

bool OptionTable::parse(Arguments arguments) const {
  CLI::App app(description_, program());
  app.allow_extras();
  app.set_help_flag("");
  std::vector<Parsed> parsed;
  for (const Option& option : arguments_) parsed.push_back({option, declare(app, option)});
  bool help = false;
  for (Option& option : options()) {
    if (option.names == "-h,--help") option.target = help_ ? help_ : &help;
    CLI::Option* results = declare(app, option);
    parsed.push_back({std::move(option), results});
  }
  rejectEmptyAssignments(*this, arguments);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError& error) {
    rejectRemaining(*this, app);
    reportError(error.what(), *this, parsed);
  }
  if (!help_ && app.count("--help") > 0) {
    writeFile("-", helpText(*this, helpWidth()));
    return false;
  }
  rejectRemaining(*this, app);
  for (const Parsed& p : parsed) assign(p);
  return true;
}

OptionTable OptionTable::withoutTargets() && {
  const auto clear = [](Option& option) { std::visit([](auto& target) { target = {}; }, option.target); };
  std::ranges::for_each(arguments_, clear);
  for (OptionGroup& group : groups_) std::ranges::for_each(group.options, clear);
  help_ = nullptr;
  return std::move(*this);
}

}  // namespace quintet::cli
