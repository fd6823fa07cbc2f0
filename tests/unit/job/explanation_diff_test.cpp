// SPDX-License-Identifier: Apache-2.0
// Where two explanations separate.
#include "job/explanation_diff.h"

#include <gtest/gtest.h>

#include <cmath>

#include "explanations.h"

namespace quintet::job {
namespace {

TEST(ExplanationDiff, FindsNothingInEqualExplanations) {
  const ExplanationDiff diff = diffExplanations(somePath(), somePath());
  EXPECT_TRUE(diff.equal());
  EXPECT_TRUE(diff.facts.empty());
  EXPECT_EQ(diff.equalEvents, 6u);
}

TEST(ExplanationDiff, NamesTheFirstEventAndBothValues) {
  PixelExplanation b = somePath();
  b.events[0].children[0].set("primitive", std::int64_t{8});
  b.events[1].set("source", std::string("background"));
  b.parameters = "bounces=2";
  const ExplanationDiff diff = diffExplanations(somePath(), b);
  ASSERT_TRUE(diff.first);
  EXPECT_EQ(diff.first->location, "ray 1, closest-hit surface.rchit: primitive");
  EXPECT_EQ(diff.first->a, "7");
  EXPECT_EQ(diff.first->b, "8");
  EXPECT_FALSE(diff.first->error);
  EXPECT_EQ(diff.equalEvents, 1u) << "the ray";
  ASSERT_EQ(diff.facts.size(), 1u);
  EXPECT_EQ(diff.facts[0].location, "parameters");
}

TEST(ExplanationDiff, MarksAllEventsThatDiffer) {
  EXPECT_TRUE(differentEvents(somePath(), somePath()).a.empty());
  PixelExplanation b = somePath();
  b.events[0].children[0].set("primitive", std::int64_t{8});
  b.events[3].set("scatterings", std::int64_t{2});
  const DifferentEvents fields = differentEvents(somePath(), b);
  EXPECT_EQ(fields.a, (std::vector<std::size_t>{1, 5}));
  EXPECT_EQ(fields.b, fields.a);

  b = somePath();
  b.events.erase(b.events.begin() + 1);  // the first contribution
  const DifferentEvents missing = differentEvents(somePath(), b);
  EXPECT_EQ(missing.a, std::vector<std::size_t>{3}) << "those after it are equal";
  EXPECT_TRUE(missing.b.empty());
  EXPECT_FALSE(missing.firstInB);
  b.events.erase(b.events.begin());
  EXPECT_EQ(differentEvents(somePath(), b).a, (std::vector<std::size_t>{0, 1, 2, 3})) << "a ray with the events in it";
  const DifferentEvents more = differentEvents(b, somePath());
  EXPECT_EQ(more.b, (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_TRUE(more.a.empty());
  EXPECT_EQ(more.firstInB, 0u);
}

TEST(ExplanationDiff, AlignsEventsAfterAnInsertedOne) {
  PixelExplanation b = somePath();
  ExplainedEvent inserted = b.events[2];  // a shadow ray
  inserted.set("tmax", 4.0f);
  b.events.insert(b.events.begin() + 1, inserted);
  b.events[3].set("direction", std::vector<float>{1, 0, 0});  // of the shadow ray that was there before
  const DifferentEvents different = differentEvents(somePath(), b);
  EXPECT_EQ(different.b, (std::vector<std::size_t>{3, 5}));
  EXPECT_EQ(different.a, std::vector<std::size_t>{4});
  EXPECT_EQ(different.firstInB, 3u);
  const ExplanationDiff diff = diffExplanations(somePath(), b);
  EXPECT_EQ(diff.first->location, "event 2");
  EXPECT_EQ(diff.first->a, "missing");
  EXPECT_EQ(diff.first->b, "ray 2");
  EXPECT_EQ(diff.equalEvents, 3u);
}

// A ray of a different kind is less similar than one with other values.
TEST(ExplanationDiff, PairsEventsOfTheSameKind) {
  PixelExplanation b = somePath();
  b.events.erase(b.events.begin() + 1);
  b.events[1].set("direction", std::vector<float>{1, 0, 0});
  b.events.erase(b.events.begin());  // the shadow ray is the first one
  const DifferentEvents different = differentEvents(somePath(), b);
  EXPECT_EQ(different.a, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(different.b, std::vector<std::size_t>{0});
  EXPECT_FALSE(different.firstInB) << "the first difference is the ray that B lacks";
}

TEST(ExplanationDiff, IgnoresRoundingAndSourceLines) {
  PixelExplanation b = somePath();
  b.events[0].set("line", std::int64_t{99});
  b.events[0].children[1].set("payload.t", 2.5f * (1.0f + 5e-5f));
  b.outputs[0].value.x *= 1.0f + 5e-5f;
  EXPECT_TRUE(diffExplanations(somePath(), b).equal());
  const ExplanationDiff strict = diffExplanations(somePath(), b, {.relative = 1e-6f, .absolute = 0.0f});
  ASSERT_TRUE(strict.first);
  EXPECT_EQ(strict.first->location, "ray 1, payload after: payload.t");
  EXPECT_NEAR(*strict.first->error, 1.25e-4f, 1e-6f);
  EXPECT_EQ(strict.outputs.size(), 1u);
}

// Members that a program has not written are undefined.
TEST(ExplanationDiff, IgnoresPayloadsThatTheCallDoesNotChange) {
  const auto withBefore = [](float before, float after) {
    PixelExplanation e = somePath();
    std::vector<ExplainedEvent>& children = e.events[0].children;
    children[1].set("payload.t", after);
    children.insert(children.begin(), children[1]);
    children[0].set("when", std::string("before"));
    children[0].set("payload.t", before);
    return e;
  };
  EXPECT_TRUE(diffExplanations(withBefore(1, 1), withBefore(2, 2)).equal());
  EXPECT_TRUE(diffExplanations(withBefore(1, 3), withBefore(2, 3)).equal());
  const ExplanationDiff changed = diffExplanations(withBefore(1, 1), withBefore(2, 3));
  ASSERT_TRUE(changed.first);
  EXPECT_EQ(changed.first->location, "ray 1, payload after: payload.t");
}

TEST(ExplanationDiff, IgnoresPayloadsBeforeTheCall) {
  PixelExplanation a = somePath();
  std::vector<ExplainedEvent>& children = a.events[0].children;
  children.insert(children.begin(), children[1]);
  children[0].set("when", std::string("before"));
  PixelExplanation b = a;
  b.events[0].children[0].set("payload.more", 1.0f);
  EXPECT_TRUE(diffExplanations(a, b).equal());
  EXPECT_TRUE(diffExplanations(b, a).equal());
}

// The tolerance of a vector follows from its largest component: a direction may have a component near 0.
TEST(ExplanationDiff, ComparesVectorsByTheirLength) {
  PixelExplanation a = somePath(), b = somePath();
  a.events[0].set("direction", std::vector<float>{1e-5f, 0.0f, -1.0f});
  b.events[0].set("direction", std::vector<float>{6e-5f, 0.0f, -1.0f});
  EXPECT_TRUE(diffExplanations(a, b).equal());
  b.events[0].set("direction", std::vector<float>{6e-4f, 0.0f, -1.0f});
  EXPECT_FALSE(diffExplanations(a, b).equal());
}

TEST(ExplanationDiff, ReportsMissingEventsAndFields) {
  PixelExplanation b = somePath();
  b.events.pop_back();
  const ExplanationDiff shorter = diffExplanations(somePath(), b);
  ASSERT_TRUE(shorter.first);
  EXPECT_EQ(shorter.first->location, "event 4");
  EXPECT_EQ(shorter.first->a, "contribution 2");
  EXPECT_EQ(shorter.first->b, "missing");
  PixelExplanation c = somePath();
  c.events[2].set("transmittance", std::vector<float>{1, 1, 1});
  const ExplanationDiff more = diffExplanations(somePath(), c);
  ASSERT_TRUE(more.first);
  EXPECT_EQ(more.first->location, "ray 2: transmittance");
  EXPECT_EQ(more.first->a, "missing");
  c.events[1].type = "store";
  const ExplanationDiff replaced = diffExplanations(somePath(), c);
  EXPECT_EQ(replaced.first->location, "event 2");
  EXPECT_EQ(replaced.first->a, "contribution 1");
  EXPECT_EQ(replaced.first->b, "store");
  EXPECT_EQ(differentEvents(somePath(), c).firstInB, 3u);
}

TEST(ExplanationDiff, ComparesNumbersThatAreNotFinite) {
  PixelExplanation a = somePath(), b = somePath();
  a.events[1].set("value", std::vector<float>{NAN, INFINITY, 0.0f});
  b.events[1].set("value", std::vector<float>{NAN, INFINITY, 0.0f});
  EXPECT_TRUE(diffExplanations(a, b).equal());
  b.events[1].set("value", std::vector<float>{1.0f, INFINITY, 0.0f});
  ASSERT_TRUE(diffExplanations(a, b).first);
  EXPECT_TRUE(std::isinf(*diffExplanations(a, b).first->error));
}

TEST(ExplanationDiff, ReportsOutputs) {
  PixelExplanation b = somePath();
  b.outputs[0].value.g = 0.6f;
  const ExplanationDiff diff = diffExplanations(somePath(), b);
  EXPECT_FALSE(diff.first);
  EXPECT_FALSE(diff.equal());
  ASSERT_EQ(diff.outputs.size(), 1u);
  EXPECT_EQ(diff.outputs[0].b, "(0.75, 0.6, 0.25, 1)");
}

}  // namespace
}  // namespace quintet::job
