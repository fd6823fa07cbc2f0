// SPDX-License-Identifier: Apache-2.0
// The lessons as a course: which exist, their order, titles and programs, as docs/lessons/README.md lists them. The pages are
// the documentation; nothing here knows what they teach.
#ifndef QUINTET_LAB_COURSE_H
#define QUINTET_LAB_COURSE_H

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::lab {

struct Lesson {
  std::string name;     // of the page: "05_shadow"
  std::string number;   // "05"
  std::string title;    // "shadow"
  std::string page;     // below docs/: "lessons/05_shadow.md"
  std::string image;    // below docs/: "images/lessons/05_shadow.png"
  std::string program;  // built-in: "lessons/05_shadow"
};

// `overview`: the text of lessons/README.md. In its tables, a cell "[NUMBER · TITLE](PAGE)" is a lesson if the cell above it has
// an image, "![…](IMAGE)"; the order is that of the text. `text` returns a page by its path below docs/, empty if it does not
// exist. A lesson whose name is not that of a program uses the program of the first excerpt in its page. Lessons without a page
// or a program are skipped.
std::vector<Lesson> courseLessons(std::string_view overview,
                                  const std::function<std::string_view(std::string_view)>& text,
                                  const std::vector<std::string>& builtInPrograms);

}  // namespace quintet::lab
#endif
