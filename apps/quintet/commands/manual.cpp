// SPDX-License-Identifier: Apache-2.0
#include "commands/manual.h"

#include <algorithm>
#include <cctype>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/command.h"
#include "job/version.h"

namespace quintet::cli {
namespace {

// Text that roff prints unchanged.
std::string roff(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else if (c == '\'')
      result += "\\(aq";
    else
      result += c;
  }
  return result.starts_with('.') ? "\\&" + result : result;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string header(const std::string& page, const std::string& summary) {
  return fmt::format(".TH {} 1 \"\" \"Quintet {}\" \"Quintet\"\n.SH NAME\n{} \\- {}\n", upper(page),
                     job::quintetVersion(), roff(page), roff(summary));
}

// "\fB\-o\fR, \fB\-\-output\fR \fIFILE\fR"
std::string optionPart(const Option& option) {
  if (option.isArgument()) return fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(option.names), roff(option.help));
  std::vector<std::string> names;
  for (const std::string& name : option.nameList()) names.push_back("\\fB" + roff(name) + "\\fR");
  const std::string value = option.value.empty() ? "" : "\\fI" + roff(option.valueForm()) + "\\fR";
  return fmt::format(".TP\n{}{}\n{}\n", fmt::join(names, ", "), value, roff(option.help));
}

std::string examplesPart(const std::vector<Example>& examples) {
  if (examples.empty()) return "";
  std::string text = ".SH EXAMPLES\n";
  for (const Example& example : examples) {
    text += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(example.command));
    if (!example.text.empty()) text += fmt::format(".RS 4\n{}\n.RE\n", roff(example.text));
  }
  return text;
}

struct Row {
  const char* name;
  const char* meaning;
};

constexpr Row kStatuses[] = {
    {"0", "Success."},
    {"1",
     "Runtime error: a file, a device, memory, or a shader that does not compile; or the limit of compare was "
     "exceeded."},
    {"2", "Wrong command line: an unknown option or program, or a value out of range."},
    {"3", "render or run wrote the image, but --spp or --time ended the render before it reached --until-error."},
    {"4", "The driver or Quintet crashed."},
    {"5", "The plan of farm run or farm merge was made by a different version of Quintet."},
    {"130, 143", "Ended by SIGINT (Ctrl-C) or SIGTERM."},
    {"137", "The process was killed (SIGKILL), possibly because memory ran out."},
};

constexpr Row kVariables[] = {
    {"QUINTET_DEVICE", "Default of --device."},
    {"QUINTET_ISOLATION", "off makes render, run, check and bench work in one process, for debuggers."},
    {"QUINTET_VALIDATE", "1 enables the validation layers of Vulkan; their messages appear as warnings."},
    {"QUINTET_CACHE_DIR", "Folder of compiled shaders and pipelines."},
    {"QUINTET_NO_SHIPPED_SHADERS", "1 compiles all shaders from GLSL, also those that the binary contains."},
    {"QUINTET_INCLUDE_ROOTS", "Folders, separated by ':', outside of which programs and scenes read no files."},
    {"QUINTET_SHADER_PATH", "Folder that replaces the built-in shader library."},
    {"QUINTET_NO_DRIVER_WORKAROUNDS", "1 keeps the variables of drivers unchanged."},
    {"NO_COLOR", "If it is not empty, the output has no colors."},
};

std::string rows(std::span<const Row> all) {
  std::string text;
  for (const Row& row : all) text += fmt::format(".TP\n.B {}\n{}\n", row.name, roff(row.meaning));
  return text;
}

}  // namespace

std::string manualPage(const OptionTable& table) {
  const std::string page = "quintet-" + commandKey(table.command());
  const auto all = commands();
  const auto command = std::ranges::find(all, table.command(), &Command::name);
  std::string text = header(page, std::string(command == all.end() ? table.description() : command->summary));
  text += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR{}\n", roff(table.program()),
                      roff(table.usage().substr(table.program().size())));
  text += fmt::format(".SH DESCRIPTION\n{}\n", roff(table.description()));
  for (const Option& argument : table.arguments()) text += optionPart(argument);
  text += ".SH OPTIONS\n";
  for (const OptionGroup& group : table.groups()) {
    text += fmt::format(".SS {}\n", roff(group.name));
    for (const Option& option : group.options) text += optionPart(option);
  }
  return text + examplesPart(table.examples()) + ".SH SEE ALSO\n.BR quintet (1)\n";
}

std::string mainManualPage() {
  std::string text = header("quintet", "Vulkan ray tracing toolkit and path tracer for glTF scenes");
  text += ".SH SYNOPSIS\n\\fBquintet\\fR \\fICOMMAND\\fR [OPTIONS]\n";
  text += ".SH DESCRIPTION\nFive shaders in, image out. Each command has a page of its own.\n.SH COMMANDS\n";
  for (const Command& command : commands())
    text += fmt::format(".TP\n.BR quintet\\-{} (1)\n{}\n", roff(commandKey(command.name)), roff(command.summary));
  text += ".SH EXIT STATUS\n" + rows(kStatuses) + ".SH ENVIRONMENT\n" + rows(kVariables) + ".SH SEE ALSO\n";
  std::vector<std::string> pages;
  for (const Command& command : commands())
    pages.push_back(fmt::format(".BR quintet\\-{} (1)", roff(commandKey(command.name))));
  return text + fmt::format("{}\n", fmt::join(pages, ",\n"));
}

}  // namespace quintet::cli
