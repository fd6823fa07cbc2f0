// SPDX-License-Identifier: Apache-2.0
// `quintet lab`: starts the program quintet-lab, the server of the lab, which gets all arguments.
#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "cli/companion.h"
#include "cli/lab_options.h"

namespace quintet::cli {

OptionTable labOptions() {
  LabOptions options;
  LabTexts texts;
  return labOptionTable(options, texts).withoutTargets();
}

int labCommand(Arguments arguments) {
  // Also reports mistakes where the server is missing.
  if (!parseLabOptions(arguments)) return 0;
  const std::filesystem::path lab = findCompanion("quintet-lab");
  if (lab.empty())
    throw Error(
        "quintet-lab, the server of the lab, not found beside quintet or in PATH; install the packages with "
        "'scripts/setup.sh lab' and build again with -DQUINTET_LAB=ON (docs/lab.md)");
  startCompanion(lab, arguments);
}

}  // namespace quintet::cli
