// SPDX-License-Identifier: Apache-2.0
// `quintet farm status`: which parts of a plan are done, and what Slurm knows of the others.
#include <filesystem>

#include "base/error.h"
#include "base/file.h"
#include "cli/command.h"
#include "cli/parser.h"
#include "commands/farm.h"
#include "farm/status.h"

namespace quintet::cli {
namespace {

struct FarmStatusOptions {
  std::filesystem::path plan;
  bool verify = false;
  bool json = false;
};

OptionTable declareFarmStatus(FarmStatusOptions& options) {
  OptionTable table(
      "farm status",
      "Shows which parts of a plan are done, missing, damaged, of a different plan or version, and with Slurm "
      "which ones are running or waiting.");
  table.add({planArgument(options.plan),
             {.names = "--verify",
              .help = "Read all parts and compare their checksums (default: only headers and lengths)",
              .target = &options.verify},
             {.names = "--json", .help = "Print one JSON object on standard output", .target = &options.json}});
  table.addExamples({{"quintet farm status farm"}, {"quintet farm status farm --json | jq .states"}});
  return table;
}

}  // namespace

OptionTable farmStatusOptions() {
  FarmStatusOptions options;
  return declareFarmStatus(options).withoutTargets();
}

int farmStatusCommand(Arguments arguments) {
  FarmStatusOptions options;
  if (!parse(declareFarmStatus(options), arguments)) return 0;
  if (options.plan.empty()) throw UsageError("no plan given; see 'quintet farm status --help'");
  const farm::Status status = farm::readStatus(farm::readPlan(options.plan),
                                               options.verify ? farm::CheckDepth::content : farm::CheckDepth::header);
  writeFile("-", options.json ? farm::statusJson(status) : farm::statusText(status));
  return 0;
}

}  // namespace quintet::cli
