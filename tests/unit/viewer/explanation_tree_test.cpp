// SPDX-License-Identifier: Apache-2.0
// The rows of an explanation: order, depth, rays, contributions, summaries and fields.
#include "viewer/explanation_tree.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "../job/explanations.h"

namespace quintet::viewer {
namespace {

ExplanationTree treeOf(job::PixelExplanation explanation) {
  return ExplanationTree(std::make_shared<const job::PixelExplanation>(std::move(explanation)));
}

// "depth name: summary"
std::vector<std::string> texts(const ExplanationTree& tree) {
  std::vector<std::string> result;
  for (const ExplanationRow& row : tree.rows())
    result.push_back(std::to_string(row.depth) + " " + row.name + ": " + row.summary);
  return result;
}

TEST(ExplanationTree, ListsWhatFollowsARayBelowIt) {
  const ExplanationTree tree = treeOf(job::somePath());
  EXPECT_EQ(texts(tree),
            (std::vector<std::string>{"0 Ray 1: radiance: hits \"floor\", 2.5 m", "1 hit: \"floor\", triangle 7, 2.5 m",
                                      "1 contribution: surface 0.5 0.25 0", "0 Ray 2: shadow: misses",
                                      "1 contribution: light sample 0.25 0.25 0.25"}));
  const std::vector<ExplanationRow>& rows = tree.rows();
  EXPECT_EQ(rows[0].end, 3u);
  EXPECT_EQ(rows[1].end, 2u);
  EXPECT_EQ(rows[3].end, 5u);
  EXPECT_EQ(rows[2].number, 3u) << "number 2 is the payload";
  EXPECT_EQ(rows[2].ray, 0u);
  EXPECT_EQ(rows[4].ray, 1u);
  EXPECT_EQ(tree.rowOfRay(1), 3u);
  EXPECT_EQ(tree.rowOfRay(2), rows.size());
  EXPECT_EQ(tree.rowOfEvent(2), 0u) << "the payload is that of the ray";
  EXPECT_EQ(tree.rowOfEvent(5), 4u);
}

TEST(ExplanationTree, AddsContributions) {
  const ExplanationTree tree = treeOf(job::somePath());
  EXPECT_EQ(tree.rows()[0].contribution, vec3(0.5f, 0.25f, 0.0f));
  EXPECT_FALSE(tree.rows()[1].contribution);
  EXPECT_EQ(tree.rows()[3].contribution, vec3(0.25f));
}

// A program that states no contributions, with a recursive ray.
TEST(ExplanationTree, NestsTheRaysOfShaders) {
  job::PixelExplanation path = job::somePath();
  const job::ExplainedEvent shadow = path.events[2];
  path.events.erase(path.events.begin() + 1, path.events.end());
  path.events[0].children[0].children.push_back(shadow);
  path.events.push_back({"store",
                         {{"output", std::string("color")},
                          {"mode", std::string("store")},
                          {"value", std::vector<float>{0.75f, 0.5f, 0.25f, 1.0f}}},
                         {}});
  const ExplanationTree tree = treeOf(path);
  EXPECT_EQ(texts(tree),
            (std::vector<std::string>{"0 Ray 1: radiance: hits \"floor\", 2.5 m", "1 hit: \"floor\", triangle 7, 2.5 m",
                                      "2 Ray 2: shadow: misses", "1 store: color = 0.75 0.5 0.25 1"}));
  EXPECT_EQ(tree.rows()[2].ray, 1u);
  EXPECT_EQ(tree.rows()[3].ray, 0u) << "it belongs to the ray whose shader has ended";
  EXPECT_EQ(tree.rows()[3].contribution, vec3(0.75f, 0.5f, 0.25f));
  EXPECT_EQ(tree.rows()[0].contribution, vec3(0.75f, 0.5f, 0.25f));
}

TEST(ExplanationTree, MarksTheRowsThatDiffer) {
  EXPECT_FALSE(compareExplanations(job::somePath(), treeOf(job::somePath())).first);
  job::PixelExplanation other = job::somePath();
  other.events[0].children[1].set("payload.t", 3.0f);
  other.events[3].set("scatterings", std::int64_t{2});
  const ExplanationComparison comparison = compareExplanations(job::somePath(), treeOf(other));
  EXPECT_EQ(comparison.differs, (std::vector<bool>{true, false, false, false, true}));
  EXPECT_EQ(comparison.first, 0u);
  EXPECT_EQ(comparison.diff.first->b, "3");
  other = job::somePath();
  other.events.pop_back();
  const ExplanationComparison shorter = compareExplanations(job::somePath(), treeOf(other));
  EXPECT_FALSE(shorter.first) << "no row has what is missing";
  EXPECT_EQ(shorter.diff.first->b, "missing");
}

// Row 1 differs, but it is not the first difference: that is the contribution, which has no row.
TEST(ExplanationTree, TheFirstDifferenceCanHaveNoRow) {
  job::PixelExplanation a = job::somePath();
  a.events[0].children.push_back(a.events[1]);
  a.events = {a.events[0], a.events[2]};
  job::PixelExplanation b = a;
  b.events[0].children.pop_back();
  b.events[1].set("direction", std::vector<float>{1, 0, 0});
  const ExplanationComparison comparison = compareExplanations(a, treeOf(b));
  EXPECT_FALSE(comparison.first);
  EXPECT_EQ(comparison.diff.first->b, "missing");
  EXPECT_EQ(comparison.differs, (std::vector<bool>{false, false, true}));
}

TEST(ExplanationTree, HasAllFieldsAndThePayload) {
  job::PixelExplanation path = job::somePath();
  std::vector<job::ExplainedEvent>& children = path.events[0].children;
  children.insert(children.begin(), children[1]);
  children[0].set("when", std::string("before"));
  children[0].set("payload.t", 1.0f);
  const std::vector<ExplanationField> fields = fieldsOf(path.events[0]);
  const auto value = [&](const std::string& name) {
    for (const ExplanationField& field : fields)
      if (field.name == name) return field.before.empty() ? field.value : field.before + " -> " + field.value;
    return std::string("missing");
  };
  EXPECT_EQ(value("ray type"), "radiance");
  EXPECT_EQ(value("direction"), "0 0 -1");
  EXPECT_EQ(value("tmax"), "infinity");
  EXPECT_EQ(value("flags"), "missing") << "empty";
  EXPECT_EQ(value("payload.t"), "1 -> 2.5");
  EXPECT_EQ(value("payload.ids"), "1 -2");
  EXPECT_EQ(fields.back().value, "main.rgen:12");
}

TEST(ExplanationTree, NamesPayloadsWithoutMembers) {
  job::PixelExplanation path = job::somePath();
  path.events[0].children[1] = {
      "payload", {{"when", std::string("before")}, {"variable", std::string("visible")}, {"value", 0.5f}}, {}};
  const std::vector<ExplanationField> fields = fieldsOf(path.events[0]);
  const auto field = std::ranges::find(fields, "visible", &ExplanationField::name);
  ASSERT_NE(field, fields.end());
  EXPECT_EQ(field->value, "0.5");
}

}  // namespace
}  // namespace quintet::viewer
