// SPDX-License-Identifier: Apache-2.0
// The environment of a process that loses devices or cannot create one: it loads the layer of layer.cpp.
#ifndef QUINTET_TESTS_DEVICE_LOSS_DEVICE_LOSS_H
#define QUINTET_TESTS_DEVICE_LOSS_DEVICE_LOSS_H

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace quintet::test {

struct DeviceLoss {
  enum class Kind {
    rendering,   // the device with ray tracing pipelines
    presenting,  // the device with a swapchain
  };
  Kind kind = Kind::rendering;
  std::filesystem::path trigger;  // the device is lost at the first submission after this file exists; absolute
  unsigned count = 1;             // of devices that are lost, one after the other
  unsigned failing = 0;           // number of the device, from 1, that cannot be created; 0 means none
};

// Variables of the environment, by name.
std::vector<std::pair<std::string, std::string>> environmentOf(const DeviceLoss& loss);

}  // namespace quintet::test
#endif
