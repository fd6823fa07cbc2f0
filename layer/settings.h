// SPDX-License-Identifier: Apache-2.0
// Settings of the layer: the variable QUINTET_LINK_CHECK, "sbt=1,output=link.sarif", and vk_layer_settings.txt, as vkconfig
// writes it ("quintet_link_check.sbt = 1"). The variable takes precedence.
#ifndef QUINTET_LAYER_SETTINGS_H
#define QUINTET_LAYER_SETTINGS_H

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::layer {

struct Settings {
  bool sbt = false;                    // read the shader binding tables of each trace
  bool wait = false;                   // check each pipeline before its creation returns
  std::filesystem::path output;        // .sarif or any other name for text; empty for standard error
  std::filesystem::path suppressions;  // check/modules/suppression_list.h; empty for none
  std::vector<std::string> problems;   // of the settings themselves, for the user
};

Settings readSettings();

// Adds "key=value,key=value".
void addVariable(Settings& settings, std::string_view text);
// Adds the lines of vk_layer_settings.txt that belong to this layer.
void addFile(Settings& settings, std::string_view text);

}  // namespace quintet::layer
#endif
