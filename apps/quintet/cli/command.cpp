// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <array>

namespace quintet::cli {

std::span<const Command> commands() {
  static constexpr std::array kCommands{
      Command{"render", "render an image of a scene", renderCommand},
      Command{"merge", "join parts of a render", mergeCommand},
      Command{"run", "run a program: your own or a built-in one", runCommand},
      Command{"new", "create a program that renders at once", newCommand},
      Command{"check", "compile and check programs, without rendering", checkCommand},
      Command{"explain", "explain a diagnostic and how to fix it", explainCommand},
      Command{"info", "describe the devices, or a scene, image or film", infoCommand},
      Command{"compare", "measure the difference between two images", compareCommand},
      Command{"bench", "measure rays per second, and compare with minimal shaders", benchCommand},
  };
  return kCommands;
}

}  // namespace quintet::cli
