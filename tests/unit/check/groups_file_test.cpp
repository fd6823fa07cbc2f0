// SPDX-License-Identifier: Apache-2.0
// groups.json: what it describes, and its errors with their JSON pointers.
#include "check/modules/groups_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "base/error.h"
#include "check/modules/suppression_list.h"

namespace quintet::check {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string errorOf(const std::string& text) {
  try {
    (void)parseGroups("groups.json", text);
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

TEST(GroupsFile, DescribesRecordsInTheirOrder) {
  const auto pipelines = parseGroups("groups.json", R"({
    // comments are allowed
    "name": "sky", "recursion_depth": 2, "ray_generation": "a.spv",
    "miss": ["b.spv", null, {"module": "lib.spv#shadow", "record": [-1, 0.5]}],
    "hit": [{"name": "ball", "closest_hit": "c.spv", "intersection": "d.spv", "record": [7]}, null],
    "descriptors": [{"set": 1, "binding": 2, "count": 16}],
    "callable": ["e.spv"],
    "specialization": {"a.spv": {"0": 4, "1": -1, "2": 0.5, "3": true}},
    "instances": [{"record_offset": 1, "mask": 3, "custom_index": 7, "geometries": [{"type": "aabbs", "opaque": true}, {"type": "triangles"}]}]
  })");
  ASSERT_EQ(pipelines.size(), 1u);
  const DescribedPipeline& p = pipelines[0];
  EXPECT_EQ(p.name, "sky");
  EXPECT_EQ(p.groups.declaredRecursion, 2u);
  EXPECT_THAT(p.groups.rayGenerations, ElementsAre("a.spv"));
  ASSERT_EQ(p.groups.misses.size(), 3u);
  EXPECT_EQ(p.groups.misses[1].file, "");
  EXPECT_EQ(p.stages.at("lib.spv#shadow").entryPoint, "shadow");
  ASSERT_EQ(p.groups.hitGroups.size(), 2u);
  EXPECT_EQ(p.groups.hitGroups[0].shaders.at("").intersection, "d.spv");
  using Words = std::vector<std::uint32_t>;
  const auto wordsOf = [](const RecordData& data) {
    Words words(data.size() / 4);
    std::memcpy(words.data(), data.data(), data.size());
    return words;
  };
  ASSERT_EQ(p.groups.recordData.misses.size(), 3u);
  EXPECT_TRUE(p.groups.recordData.misses[0].empty());
  EXPECT_EQ(wordsOf(p.groups.recordData.misses[2]), (Words{0xFFFFFFFFu, 0x3F000000u}));
  EXPECT_EQ(wordsOf(p.groups.recordData.hits[0]), Words{7});
  EXPECT_EQ(p.groups.descriptorCounts.at({1, 2}), 16u);
  EXPECT_EQ(p.specialization.at("a.spv").at(1), std::vector<std::uint32_t>{0xFFFFFFFFu});
  EXPECT_EQ(p.specialization.at("a.spv").at(2), std::vector<std::uint32_t>{0x3F000000u});
  ASSERT_TRUE(p.groups.instances);
  EXPECT_EQ(p.groups.instances->at(0).recordOffset, 1u);
  EXPECT_TRUE(p.groups.instances->at(0).hasCustomIndex);
  EXPECT_EQ(p.groups.instances->at(0).facts.customIndex, 7u);
  EXPECT_EQ(p.groups.instances->at(0).facts.geometryCount, 2u);
  EXPECT_TRUE(p.groups.geometries[0].procedural());
  EXPECT_FALSE(p.groups.geometries[1].opaque());
}

TEST(GroupsFile, NamesTheJsonPathOfErrors) {
  EXPECT_THAT(errorOf("{"), HasSubstr("groups.json: byte 2: this is not valid JSON"));
  EXPECT_THAT(errorOf("// \"\n" + std::string(200000, '[')), HasSubstr("line 2, column 257: more than 256 nested"));
  EXPECT_THAT(errorOf("[]"), AllOf(HasSubstr("groups.json: /: "), HasSubstr("must be an object")));
  EXPECT_THAT(errorOf("{}"), HasSubstr("'ray_generation' is missing"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "mis": []})"), HasSubstr("/mis: unknown member 'mis' (did you mean"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "miss": [3]})"), HasSubstr("/miss/0: must be a string"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "hit": [{"any": "b"}]})"), HasSubstr("/hit/0/any: unknown member"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "recursion_depth": -1})"), HasSubstr("/recursion_depth: must be an"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "specialization": {"b/c": {}}})"),
              HasSubstr("/specialization/b~1c: no group uses"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "specialization": {"a": {"x": 1}}})"), HasSubstr("not a constant_id"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "instances": [{}]})"),
              AllOf(HasSubstr("/instances/0: "), HasSubstr("'geometries' is missing")));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "instances": [{"geometries": [{"type": "box"}]}]})"),
              HasSubstr("/instances/0/geometries/0/type: unknown type 'box'"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "instances": [{"custom_index": 16777216, "geometries": []}]})"),
              HasSubstr("/instances/0/custom_index: must be an"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "miss": [{"record": [1]}]})"),
              HasSubstr("/miss/0: 'module' is missing"));
  EXPECT_THAT(errorOf(R"({"ray_generation": {"module": "a", "record": ["x"]}})"),
              HasSubstr("/ray_generation/record/0: must be a boolean, an integer"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "descriptors": [{"set": 0, "binding": 1}]})"),
              HasSubstr("/descriptors/0: 'count' is missing"));
  EXPECT_THAT(errorOf(R"({"ray_generation": "a", "descriptors": [{"set": 0, "binding": 1, "count": 2},
                                                                 {"set": 0, "binding": 1, "count": 3}]})"),
              HasSubstr("/descriptors/1: set 0 and binding 1 are listed twice"));
  EXPECT_THAT(errorOf(R"({"pipelines": []})"), HasSubstr("/pipelines: the list is empty"));
}

TEST(SuppressionList, AcceptsByIdFileAndLine) {
  const SuppressionList list = SuppressionList::parse("s.txt", R"(# accepted
Q104 raygen.rgen:12  # a default
Q705
q101 shaders/a.rchit
)");
  const auto accepts = [&](const char* id, const char* file, int line) {
    return list.accepts({Severity::error, file, line, 0, id, "text", {}});
  };
  EXPECT_TRUE(accepts("Q104", "x/raygen.rgen", 12));
  EXPECT_FALSE(accepts("Q104", "x/raygen.rgen", 13));
  EXPECT_FALSE(accepts("Q104", "x/myraygen.rgen", 12));
  EXPECT_TRUE(accepts("Q705", "", 0));
  EXPECT_TRUE(accepts("Q101", "my/shaders/a.rchit", 1));
  EXPECT_FALSE(accepts("Q101", "a.rchit", 1));
}

TEST(SuppressionList, NamesTheLineOfAnUnknownId) {
  try {
    (void)SuppressionList::parse("s.txt", "\nQ9999\n");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("s.txt: line 2: unknown diagnostic 'Q9999'"));
  }
}

}  // namespace
}  // namespace quintet::check
