// SPDX-License-Identifier: Apache-2.0
// `quintet licenses`: the license of Quintet, and those of the code by others that its binaries contain.
#include <span>
#include <string>

#include "base/embedded.h"
#include "base/error.h"
#include "base/file.h"
#include "cli/command.h"
#include "cli/option_table.h"
#include "cli/parser.h"

namespace quintet::cli {

std::span<const EmbeddedFile> embeddedNotices();  // cmake/QuintetNotices.cmake

namespace {

OptionTable declareLicenses() {
  OptionTable table("licenses", "Prints the licenses of Quintet and of the code by others in its programs.");
  table.addExamples({{"quintet licenses", "all license texts"}, {"quintet licenses | less"}});
  return table;
}

}  // namespace

OptionTable licensesOptions() { return declareLicenses().withoutTargets(); }

int licensesCommand(Arguments arguments) {
  if (!parse(declareLicenses(), arguments)) return 0;
  const std::span<const EmbeddedFile> files = embeddedNotices();
  if (files.size() != 1) throw Error("this build of quintet has no license texts; build it again");
  writeFile("-", "Quintet has the license Apache-2.0 (https://www.apache.org/licenses/LICENSE-2.0).\n" +
                     std::string(files.front().data));
  return 0;
}

}  // namespace quintet::cli
