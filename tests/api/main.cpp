// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <quintet/device.h>

int main(int argc, char** argv) {
  quintet::prepareDrivers();  // before other threads exist
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
