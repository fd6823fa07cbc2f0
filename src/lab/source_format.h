// SPDX-License-Identifier: Apache-2.0
// Formats GLSL with clang-format, if it is installed on the machine of the server. Only white space changes; any other change
// counts as a failure, because clang-format reads GLSL as C.
#ifndef QUINTET_LAB_SOURCE_FORMAT_H
#define QUINTET_LAB_SOURCE_FORMAT_H

#include <filesystem>
#include <string>

namespace quintet::lab {

// clang-format, or clang-format-14, in the folders of $PATH; empty if neither is installed.
std::filesystem::path findFormatter();

inline constexpr double kFormatSeconds = 5;  // that the formatter may take

// Throws Error if the formatter fails, takes longer, or would change more than white space.
std::string formatSource(const std::filesystem::path& formatter, const std::string& text);

}  // namespace quintet::lab
#endif
