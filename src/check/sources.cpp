// SPDX-License-Identifier: Apache-2.0
#include "check/sources.h"

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "base/file.h"
#include "shader/library.h"

namespace quintet::check {
namespace {

std::optional<std::string> inLibrary(const std::string& path) {
  const auto library = embeddedShaderLibrary();
  const auto found = std::ranges::find(library, std::string_view(path), &EmbeddedFile::path);
  return found == library.end() ? std::nullopt : std::optional(std::string(found->data));
}

std::optional<std::string> onDisk(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  try {
    return readTextFile(path);
  } catch (const FileError&) {
    return std::nullopt;
  }
}

}  // namespace

std::string withoutBrackets(const std::string& file) {
  return program::isLibraryStage(file) ? file.substr(1, file.size() - 2) : file;
}

SourceLookup sourcesOf(const program::Program& program) {
  return [&program](const std::string& file) -> std::optional<std::string> {
    for (const auto& [path, text] : program.files)
      if (program.path(path) == file) return text;
    return sourcesOnDisk()(file);
  };
}

SourceLookup sourcesOnDisk() {
  return [](const std::string& file) {
    const std::optional<std::string> text = inLibrary(withoutBrackets(file));
    return text ? text : onDisk(file);
  };
}

}  // namespace quintet::check
