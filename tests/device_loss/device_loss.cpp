// SPDX-License-Identifier: Apache-2.0
#include "device_loss.h"

namespace quintet::test {

std::vector<std::pair<std::string, std::string>> environmentOf(const DeviceLoss& loss) {
  return {{"VK_ADD_LAYER_PATH", QUINTET_DEVICE_LOSS_FOLDER},
          {"VK_INSTANCE_LAYERS", "VK_LAYER_QUINTET_device_loss"},
          {"QUINTET_LOSE_DEVICE", loss.kind == DeviceLoss::Kind::rendering ? "rendering" : "presenting"},
          {"QUINTET_LOSE_WHEN", loss.trigger.string()},
          {"QUINTET_LOSE_COUNT", std::to_string(loss.count)},
          {"QUINTET_FAIL_DEVICE", std::to_string(loss.failing)}};
}

}  // namespace quintet::test
