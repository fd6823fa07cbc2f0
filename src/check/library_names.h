// SPDX-License-Identifier: Apache-2.0
// Names that the library declares. The lecture form renames some of them (quintet/names_begin.glsl).
#ifndef QUINTET_CHECK_LIBRARY_NAMES_H
#define QUINTET_CHECK_LIBRARY_NAMES_H

#include <string>
#include <string_view>

namespace quintet::check {

inline constexpr std::string_view kLecturePrefix = "gsn", kLectureSuffix = "_";

// In the lecture form, `hit` becomes this attribute with the report (program/lecture/stage.cpp).
inline constexpr std::string_view kLectureAttribute = "gsnHitAttribute_";

// The name of a structure of the library in the lecture form: "gsnLaunch_" for "Launch".
inline std::string lectureName(std::string_view name) {
  return std::string(kLecturePrefix) + std::string(name) + std::string(kLectureSuffix);
}

// Returns the name of a structure in the library: "Launch" for "gsnLaunch_". Other names are returned as they are.
constexpr std::string_view libraryName(std::string_view name) {
  if (!name.starts_with(kLecturePrefix) || !name.ends_with(kLectureSuffix)) return name;
  return name.substr(kLecturePrefix.size(), name.size() - kLecturePrefix.size() - kLectureSuffix.size());
}

}  // namespace quintet::check
#endif
