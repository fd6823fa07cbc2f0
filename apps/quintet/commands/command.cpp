// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <array>

#include "cli/option_table.h"

namespace quintet::cli {

std::span<const Command> commands() {
  static constexpr std::array kCommands{
      Command{"render", "render an image of a scene", renderCommand, renderOptions, true},
      Command{"merge", "join parts of a render", mergeCommand, mergeOptions},
      Command{"farm plan", "split a render for many machines", farmPlanCommand, farmPlanOptions},
      Command{"farm run", "render a part of a plan", farmRunCommand, farmRunOptions, true},
      Command{"farm merge", "verify and join the parts of a plan", farmMergeCommand, farmMergeOptions},
      Command{"farm status", "show which parts of a plan are done", farmStatusCommand, farmStatusOptions},
      Command{"run", "run a program: your own or a built-in one", runCommand, runOptions, true},
      Command{"view", "show a scene in a window, or run a scripted session", viewCommand, viewOptions, true},
      Command{"lab", "write shaders in a browser beside a live image", labCommand, labOptions},
      Command{"new", "create a program that renders at once", newCommand, newOptions},
      Command{"check", "compile and check programs, without rendering", checkCommand, checkOptions, true},
      Command{"explain", "explain a diagnostic and how to fix it", explainCommand, explainOptions},
      Command{"explain-pixel", "explain one sample of a pixel: its rays and what they contribute", explainPixelCommand,
              explainPixelOptions, true},
      Command{"find", "find samples that are not finite, and fireflies", findCommand, findOptions, true},
      Command{"info", "describe the devices, or a scene, image or film", infoCommand, infoOptions},
      Command{"compare", "measure the difference between two images", compareCommand, compareOptions},
      Command{"bench", "measure rays per second, and compare with minimal shaders", benchCommand, benchOptions, true},
      Command{"help", "print the help of a command", helpCommand, helpOptions},
  };
  return kCommands;
}

}  // namespace quintet::cli
