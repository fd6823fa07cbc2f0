#include "commands.h"

#include <array>

namespace quintet::app {

std::span<const Command> commands() {
  static constexpr std::array kCommands{
      Command{"render", "make a picture of a scene", renderCommand},
      Command{"merge", "join parts of a rendering", mergeCommand},
      Command{"run", "run a program: your own or a built-in one", runCommand},
      Command{"new", "begin a program that renders at once", newCommand},
      Command{"check", "compile and check programs, without rendering", checkCommand},
      Command{"explain", "say what a diagnostic means and how to mend it", explainCommand},
      Command{"info", "say what a device can do, or what is in a scene, picture or film", infoCommand},
      Command{"compare", "say how far two pictures are apart", compareCommand},
      Command{"bench", "measure rays per second against the ceiling of the device", benchCommand},
  };
  return kCommands;
}

}  // namespace quintet::app
