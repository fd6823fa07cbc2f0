// SPDX-License-Identifier: Apache-2.0
// Descriptions of programs (program.toml).
#include "program/description/parser.h"
#include "target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  acceptErrors([&] {
    const program::Program program =
        program::parseProgram(std::string(textOf(input)), "input", "folder",
                              {{"main.rgen", ""}, {"sky.rmiss", ""}, {"surface.rchit", ""}, {"box.scene.toml", ""}});
    (void)program::missShaders(program);
    (void)program::optionalOutputs(program);
  });
}

}  // namespace quintet::fuzz
