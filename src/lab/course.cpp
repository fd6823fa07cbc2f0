// SPDX-License-Identifier: Apache-2.0
#include "lab/course.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/parse.h"

namespace quintet::lab {
namespace {

constexpr std::string_view kFolder = "lessons/", kPageEnd = ".md", kSeparator = " · ";

// The text between two marks, and what follows; nothing if a mark is missing.
struct Between {
  std::string_view inside, rest;
};
std::optional<Between> between(std::string_view text, std::string_view begin, std::string_view end) {
  const std::size_t from = text.find(begin);
  if (from == text.npos) return {};
  const std::size_t inside = from + begin.size();
  const std::size_t to = text.find(end, inside);
  if (to == text.npos) return {};
  return Between{text.substr(inside, to - inside), text.substr(to + end.size())};
}

// "../images/x.png" in lessons/README.md → "images/x.png".
std::string belowDocs(std::string_view target) {
  constexpr std::string_view kUp = "../";
  return target.starts_with(kUp) ? std::string(target.substr(kUp.size())) : std::string(kFolder).append(target);
}

// Path below docs/ of the image in a cell of a table; empty if it has none.
std::string imageOf(std::string_view cell) {
  const auto mark = between(cell, "![", "](");
  const auto image = mark ? between(mark->rest, "", ")") : std::nullopt;
  return image ? belowDocs(image->inside) : "";
}

// Without image and program.
std::optional<Lesson> lessonOf(std::string_view cell) {
  const auto title = between(cell, "[", "](");
  const auto page = title ? between(title->rest, "", ")") : std::nullopt;
  const std::size_t separator = title ? title->inside.find(kSeparator) : cell.npos;
  if (!page || separator == cell.npos || !page->inside.ends_with(kPageEnd)) return {};
  Lesson lesson;
  lesson.name = page->inside.substr(0, page->inside.size() - kPageEnd.size());
  lesson.number = title->inside.substr(0, separator);
  lesson.title = title->inside.substr(separator + kSeparator.size());
  lesson.page = belowDocs(page->inside);
  return lesson;
}

std::string programOf(const Lesson& lesson, std::string_view page, const std::vector<std::string>& programs) {
  const auto exists = [&](const std::string& name) { return std::ranges::find(programs, name) != programs.end(); };
  if (const std::string own = std::string(kFolder) + lesson.name; exists(own)) return own;
  const auto excerpt = between(page, "<!-- excerpt: programs/", " ");
  if (!excerpt) return {};
  const std::string folder(excerpt->inside.substr(0, excerpt->inside.rfind('/')));
  return exists(folder) ? folder : "";
}

}  // namespace

std::vector<Lesson> courseLessons(std::string_view overview,
                                  const std::function<std::string_view(std::string_view)>& text,
                                  const std::vector<std::string>& builtInPrograms) {
  std::vector<Lesson> lessons;
  std::vector<std::string> images;  // of the row above, by column
  for (const std::string& row : splitText(std::string(overview), '\n')) {
    const std::vector<std::string> cells = splitText(row, '|');
    std::vector<std::string> rowImages;
    for (std::size_t column = 0; column < cells.size(); ++column) {
      rowImages.push_back(imageOf(cells[column]));
      std::optional<Lesson> lesson = rowImages.back().empty() ? lessonOf(cells[column]) : std::nullopt;
      if (!lesson || column >= images.size() || images[column].empty()) continue;
      lesson->image = images[column];
      const std::string_view page = text(lesson->page);
      lesson->program = programOf(*lesson, page, builtInPrograms);
      if (!page.empty() && !lesson->program.empty()) lessons.push_back(std::move(*lesson));
    }
    images = std::move(rowImages);
  }
  return lessons;
}

}  // namespace quintet::lab
