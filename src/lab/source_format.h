// SPDX-License-Identifier: Apache-2.0
// Formats GLSL with clang-format, if it is installed on the machine of the server. Only white space changes; any other change
// counts as a failure, because clang-format reads GLSL as C. The formatter is a process of its own: the caller asks from time
// to time whether it has ended, and does not wait for it.
#ifndef QUINTET_LAB_SOURCE_FORMAT_H
#define QUINTET_LAB_SOURCE_FORMAT_H

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace quintet::lab {

// clang-format, or clang-format-14, in the folders of $PATH; empty if neither is installed.
std::filesystem::path findFormatter();

inline constexpr double kFormatSeconds = 5;  // that the formatter may take

// A run of the formatter. The destructor ends a process that still runs.
class SourceFormat {
 public:
  // Starts the formatter. Throws Error if that fails.
  SourceFormat(const std::filesystem::path& formatter, std::string text);
  ~SourceFormat();
  SourceFormat(const SourceFormat&) = delete;
  SourceFormat& operator=(const SourceFormat&) = delete;

  // The formatted text once the formatter has ended, nothing before. Throws Error if it failed, has taken longer than
  // kFormatSeconds, or would change more than white space.
  std::optional<std::string> poll();

 private:
  struct Run;
  const std::string name_, text_;
  std::unique_ptr<Run> run_;
};

}  // namespace quintet::lab
#endif
