// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "gpu/driver_environment.h"
#include "harness.h"

int main(int argc, char** argv) {
  quintet::gpu::prepareDriverEnvironment();  // before other threads exist
  testing::InitGoogleTest(&argc, argv);
  return quintet::test::runDeviceTests();
}
