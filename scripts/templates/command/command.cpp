// SPDX-License-Identifier: Apache-2.0
// `quintet @NAME@`: the number of bytes of a file. Replace this example.
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "cli/parser.h"

namespace quintet::cli {
namespace {

struct @Name@Options {
  std::string file;
};

OptionTable declare@Name@(@Name@Options& options) {
  OptionTable table("@NAME@", "Prints the number of bytes of a file.");
  table.add({{.names = "FILE",
              .help = "A file",
              .target = &options.file,
              .candidates = {.extensions = {"*"}},
              .required = true}});
  table.addExamples({{"quintet @NAME@ scene.glb", "the number of its bytes"}});
  return table;
}

}  // namespace

OptionTable @name@Options() {
  @Name@Options options;
  return declare@Name@(options).withoutTargets();
}

int @name@Command(Arguments arguments) {
  @Name@Options options;
  if (!parse(declare@Name@(options), arguments)) return 0;
  if (options.file.empty()) throw UsageError("no file given; see 'quintet @NAME@ --help'");
  writeFile("-", fmt::format("{}\n", readFile(options.file).size()));
  return 0;
}

}  // namespace quintet::cli
