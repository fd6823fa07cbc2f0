// SPDX-License-Identifier: Apache-2.0
// Metadata of glTF files (KHR_xmp_json_ld).
#include "scene/gltf/metadata.h"

#include <gmock/gmock.h>

#include "scene/error_matcher.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;

std::vector<std::string> linesOf(const scene::Report& report) {
  std::vector<std::string> lines;
  for (const scene::MetadataEntry& entry : report.metadata)
    lines.push_back(entry.object + " | " + entry.name + " | " + entry.value);
  return lines;
}

// Simple values, lists, language alternatives and structures.
constexpr const char* kPackets = R"([
  {"@context": {"dc": "http://purl.org/dc/elements/1.1/"}, "dc:format": "model/gltf-binary",
   "dc:creator": {"@list": ["A", "B\u0007"]},
   "dc:title": {"@type": "rdf:Alt", "rdf:_1": {"@language": "en-us", "@value": "Car"},
                "rdf:_2": {"@language": "it-it", "@value": "Auto"}},
   "x:lens": {"x:mount": "EF", "x:lengths": {"@set": [24, 70]}}},
  {"dc:rights": "free", "x:rating": 5, "x:final": true}
])";

struct MetadataBuilder : GltfBuilder {
  MetadataBuilder() {
    addTriangle();
    root["extensionsUsed"] = {"KHR_xmp_json_ld"};
    root["extensions"]["KHR_xmp_json_ld"]["packets"] = Json::parse(kPackets);
    const Json use = {{"KHR_xmp_json_ld", {{"packet", 0}}}};
    for (Json* object : {&root["asset"], &root["nodes"][0], &root["meshes"][0]}) (*object)["extensions"] = use;
  }
};

TEST(GltfMetadata, ListsTheProperties) {
  const scene::Report report = MetadataBuilder().load().report;
  EXPECT_THAT(linesOf(report), ElementsAre("/asset, /nodes/0, /meshes/0 | dc:creator | A, B?",
                                           "/asset, /nodes/0, /meshes/0 | dc:format | model/gltf-binary",
                                           "/asset, /nodes/0, /meshes/0 | dc:title | Car (en-us), Auto (it-it)",
                                           "/asset, /nodes/0, /meshes/0 | x:lens/x:lengths | 24, 70",
                                           "/asset, /nodes/0, /meshes/0 | x:lens/x:mount | EF", " | dc:rights | free",
                                           " | x:final | true", " | x:rating | 5"));
  EXPECT_TRUE(report.isExact());
}

TEST(GltfMetadata, ChecksTheIndices) {
  MetadataBuilder builder;
  builder.root["asset"]["extensions"]["KHR_xmp_json_ld"]["packet"] = 2;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/asset/extensions/KHR_xmp_json_ld/packet", "metadata packet 2"));
}

}  // namespace
}  // namespace quintet::test
