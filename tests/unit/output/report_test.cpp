// SPDX-License-Identifier: Apache-2.0
// The reports of commands as JSON.
#include "output/report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace quintet::output {
namespace {

TEST(ErrorJson, NamesFileAndLocation) {
  const FileError error("a.gltf", "/nodes/0", "is \"broken\"");
  EXPECT_EQ(
      errorJson(error.what(), &error, 1),
      R"({"error":{"message":"a.gltf: /nodes/0: is \"broken\"","file":"a.gltf","location":"/nodes/0","exitStatus":1}})"
      "\n");
}

TEST(ErrorJson, UnknownValuesAreNull) {
  const FileError error("a.gltf", "is missing");
  EXPECT_TRUE(nlohmann::json::parse(errorJson(error.what(), &error, 1))["error"]["location"].is_null());
  const auto json = nlohmann::json::parse(errorJson("wrong", nullptr, 2))["error"];
  EXPECT_TRUE(json["file"].is_null());
  EXPECT_TRUE(json["location"].is_null());
  EXPECT_EQ(json["exitStatus"], 2);
}

}  // namespace
}  // namespace quintet::output
