// SPDX-License-Identifier: Apache-2.0
// Temporary folders and helpers to compile small sources.
#ifndef QUINTET_TESTS_UNIT_SHADER_SUPPORT_H
#define QUINTET_TESTS_UNIT_SHADER_SUPPORT_H

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "base/file.h"
#include "shader/compiler.h"

namespace quintet::shader {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "quintet-shader-XXXXXX").string();
    if (::mkdtemp(pattern.data())) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, std::string_view text) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    writeFile(file, text);
    return file;
  }

 private:
  std::filesystem::path path_;
};

// Returns a compute shader with `head` before main and `body` in main. `head` starts at line 4.
inline std::string computeText(const std::string& head, const std::string& body = "b.x = 1;") {
  return "#version 460\nlayout(local_size_x = 1) in;\nlayout(binding = 0) buffer B { int x; } b;\n" + head +
         "\nvoid main() { " + body + " }\n";
}

inline Source computeSource(const std::string& head, const std::string& body = "b.x = 1;",
                            const std::string& name = "test.comp") {
  Source source;
  source.text = computeText(head, body);
  source.name = name;
  return source;
}

inline const Diagnostic* firstOf(const Result& result, Severity severity) {
  const auto at = std::ranges::find(result.diagnostics, severity, &Diagnostic::severity);
  return at == result.diagnostics.end() ? nullptr : &*at;
}

inline std::string all(const Result& result) {
  std::string text;
  for (const Diagnostic& d : result.diagnostics) text += d.format() + "\n";
  return text;
}

}  // namespace quintet::shader
#endif
