// SPDX-License-Identifier: Apache-2.0
#include "lab/course.h"

#include <gmock/gmock.h>

namespace quintet::lab {
namespace {

constexpr std::string_view kOverview = R"(# Lessons

See [reference](reference.md).

| | |
| --- | --- |
| ![Stages](../images/lessons/00_stages.svg) | ![Shadow](../images/lessons/05_shadow.png) |
| [00 · the pipeline](00_pipeline.md): stages | [05 · shadow](05_shadow.md): rays |
| ![](../images/lessons/06_gone.png) | ![](../images/lessons/07_lost.png) |
| [06 · without a page](06_gone.md) | [07 · without a program](07_lost.md) |
| ![](broken | |
| [08 · broken | [05 · without an image](05_shadow.md) |
)";

std::string_view pageText(std::string_view page) {
  if (page == "lessons/00_pipeline.md")
    return "text\n<!-- excerpt: programs/lessons/05_shadow/shadow.rt.glsl from \"x\" -->\n";
  if (page == "lessons/05_shadow.md") return "text";
  if (page == "lessons/07_lost.md") return "<!-- excerpt: programs/lessons/99_lost/lost.rt.glsl -->";
  return {};
}

TEST(Course, ListsTheLessonsOfTheOverview) {
  const std::vector<Lesson> lessons = courseLessons(kOverview, pageText, {"ao", "lessons/05_shadow"});
  ASSERT_EQ(lessons.size(), 2u);
  EXPECT_EQ(lessons[0].name, "00_pipeline");
  EXPECT_EQ(lessons[0].program, "lessons/05_shadow");  // of its first excerpt
  EXPECT_EQ(lessons[0].image, "images/lessons/00_stages.svg");
  EXPECT_EQ(lessons[1].name, "05_shadow");
  EXPECT_EQ(lessons[1].number, "05");
  EXPECT_EQ(lessons[1].title, "shadow");
  EXPECT_EQ(lessons[1].page, "lessons/05_shadow.md");
  EXPECT_EQ(lessons[1].program, "lessons/05_shadow");
}

}  // namespace
}  // namespace quintet::lab
