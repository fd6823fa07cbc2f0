// SPDX-License-Identifier: Apache-2.0
#include "job/test_engine.h"

#include <memory>

#include <gtest/gtest.h>

#include "harness.h"

namespace quintet::job {
namespace {

std::unique_ptr<Engine> owned;

// Torn down before the environment of the harness, which was registered first.
struct Cleaner : testing::Environment {
  void TearDown() override { owned.reset(); }
};

}  // namespace

Engine& testEngine() {
  if (!owned) {
    owned = std::make_unique<Engine>(EngineOptions{.log = quintet::test::testLog()});
    testing::AddGlobalTestEnvironment(new Cleaner);
  }
  return *owned;
}

}  // namespace quintet::job
