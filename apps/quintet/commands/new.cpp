// SPDX-License-Identifier: Apache-2.0
// `quintet new`: creates a program that renders at once, from a template or as a copy of an existing program.
#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "cli/candidates.h"
#include "cli/parser.h"
#include "program/new_program.h"

namespace quintet::cli {
namespace {

OptionTable declareNew(program::NewProgramOptions& options) {
  OptionTable table("new", "Creates a program that renders at once: one file, or a folder.");
  table.add({{.names = "NAME",
              .help = "Name of the program; parent folders are created",
              .target = &options.name,
              .candidates = {.folders = true},
              .required = true},
             {.names = "--from",
              .value = "PROGRAM",
              .help = "Copy this program: a lesson, another built-in program, or a path",
              .target = &options.from,
              .candidates = programCandidates()},
             {.names = "--folder",
              .help = "Create a folder with program.toml instead of one file",
              .target = &options.folder}});
  table.addExamples({
      {"quintet new first", "first.rt.glsl, a commented lesson in one file"},
      {"quintet new sketches/first --folder", "the same as a folder with program.toml"},
      {"quintet new mine --from pathtracer", "a copy of a built-in program (quintet run --list)"},
  });
  return table;
}

}  // namespace

OptionTable newOptions() {
  program::NewProgramOptions options;
  return declareNew(options).withoutTargets();
}

int newCommand(Arguments arguments) {
  program::NewProgramOptions options;
  if (!parse(declareNew(options), arguments)) return 0;
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
