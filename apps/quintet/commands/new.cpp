// SPDX-License-Identifier: Apache-2.0
// `quintet new`: creates a program that renders at once, from a template or as a copy of an existing program.
#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "cli/parser.h"
#include "cli/values.h"
#include "program/new_program.h"

namespace quintet::cli {
namespace {

constexpr const char* kExamples =
    "  quintet new first                       first.rt.glsl, a commented lesson in one file\n"
    "  quintet new sketches/first --folder     the same as a folder with program.toml\n"
    "  quintet new mine --from pathtracer      a copy of a built-in program (quintet run --list)\n";

}  // namespace

int newCommand(Arguments arguments) {
  CLI::App app("Creates a program that renders at once: one file, or a folder.", "quintet new");
  program::NewProgramOptions options;
  app.add_option("NAME", options.name, "Name of the program; parent folders are created")->type_name("");
  app.add_option("--from", options.from, "Copy this program: a lesson, another built-in program, or a path")
      ->type_name("PROGRAM");
  app.add_flag("--folder", options.folder, "Create a folder with program.toml instead of one file");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;
  if (options.name.empty()) throw UsageError("no name given; see 'quintet new --help'");

  const program::NewProgram created = program::planNewProgram(options);
  program::createProgram(created);
  const std::string name = shellQuoted(created.program.string());
  std::string text = fmt::format("{}: created", printable(created.program.string()));
  if (created.files.size() > 1) text += fmt::format(", {} files", created.files.size());
  text += fmt::format(
      "\n\nNext:\n  quintet run {} --watch    render it, and again after each save\n"
      "  quintet run {} --help     its parameters\n",
      name, name);
  writeFile("-", text);
  return 0;
}

}  // namespace quintet::cli
