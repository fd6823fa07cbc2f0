// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "harness.h"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return quintet::test::runDeviceTests();
}
