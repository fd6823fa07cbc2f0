// SPDX-License-Identifier: Apache-2.0
// Resolves the #include directives of one compilation and keeps the texts of the files that it found.
//
// #include <x>  searches the virtual files, the override folder, the embedded library, the include folders.
// #include "x"  searches relative to the including file (on disk or in the library), then as <x>.
// Files on disk must be in the FileRoots of the environment, if it has any.
#ifndef QUINTET_SHADER_INCLUDE_RESOLVER_H
#define QUINTET_SHADER_INCLUDE_RESOLVER_H

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/embedded.h"
#include "base/file_roots.h"
#include "shader/source.h"

namespace quintet::shader {

struct SourceFile {
  std::string name;                // in diagnostics: a path, or "<quintet/bsdf/ggx.glsl>" for a file in memory
  std::string libraryPath;         // path in the library: "quintet/bsdf/ggx.glsl"; empty if it is not part of it
  std::filesystem::path diskPath;  // empty for a file in memory
  std::string_view text;
  std::string storage;  // owns `text` if it was read from disk
};

struct IncludeDirective {
  std::string_view name;
  bool quoted = false;
  auto operator<=>(const IncludeDirective&) const = default;
};

// Returns all #include lines of a text, including those in comments and in disabled branches of #if.
std::vector<IncludeDirective> findIncludes(std::string_view text);

class IncludeResolver {
 public:
  // All arguments must outlive the resolver.
  IncludeResolver(const Source& source, const CompilerOptions& options, std::span<const EmbeddedFile> library);

  const SourceFile& root() const { return root_; }
  // Returns null if the file is not found. The result is valid as long as the resolver.
  const SourceFile* resolve(const SourceFile& from, const IncludeDirective& include);
  // Returns the file with this name in diagnostics; null if unknown.
  const SourceFile* find(std::string_view name) const;
  // Returns the text of the file with this name in diagnostics, including virtual files that the source only names in
  // #line "name"; empty if unknown.
  std::string_view textOf(std::string_view name) const;
  // The root and all files found so far.
  std::vector<const SourceFile*> files() const;
  bool limited() const { return roots_.limited(); }  // to the FileRoots of the environment
  // The folders that resolve() searches, in order, for an error message.
  std::vector<std::string> searchedFolders(const SourceFile& from, bool quoted) const;

 private:
  // The folder on disk where quoted includes are searched; nullopt if there is none.
  std::optional<std::filesystem::path> folderOnDisk(const SourceFile& from) const;
  const SourceFile* inVirtualFiles(const std::string& name);
  const SourceFile* inLibrary(const std::string& name);
  const SourceFile* onDisk(const std::filesystem::path& path, const std::string& libraryPath);
  const SourceFile* ofProgram(const std::filesystem::path& path, const std::string& libraryPath);
  const SourceFile* keep(SourceFile file);

  const Source& source_;
  const CompilerOptions& options_;
  std::span<const EmbeddedFile> library_;
  const FileRoots roots_ = FileRoots::fromEnvironment();
  SourceFile root_;
  std::map<std::string, SourceFile, std::less<>> files_;  // by SourceFile::name
};

}  // namespace quintet::shader
#endif
