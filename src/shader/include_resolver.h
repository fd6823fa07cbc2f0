// Where an #include leads, for one compilation: virtual files, the folders on disk, the embedded
// library. Keeps the text of every file that it has found.
//
// #include <x>  virtual files, the override folder, the embedded library, the include folders.
// #include "x"  first relative to the including file (on disk, or within the library), then as <x>.
#ifndef QUINTET_SHADER_INCLUDE_RESOLVER_H
#define QUINTET_SHADER_INCLUDE_RESOLVER_H

#include <span>

#include "base/embedded.h"
#include "shader/compiler.h"

namespace quintet::shader {

struct SourceFile {
  std::string name;                // in diagnostics: a path, or "<quintet/bsdf/ggx.glsl>" if in memory
  std::string libraryPath;         // name in the library: "quintet/bsdf/ggx.glsl"; empty: not part of it
  std::filesystem::path diskPath;  // empty: in memory
  std::string_view text;
  std::string storage;  // holds `text` if it was read from disk
};

struct IncludeDirective {
  std::string_view name;
  bool quoted = false;
  auto operator<=>(const IncludeDirective&) const = default;
};

// Every #include line of a text, also those that comments or #if switch off.
std::vector<IncludeDirective> findIncludes(std::string_view text);

class IncludeResolver {
 public:
  // All arguments must outlive the resolver.
  IncludeResolver(const Source& source, const CompilerOptions& options, std::span<const EmbeddedFile> library);

  const SourceFile& root() const { return root_; }
  // Null: not found. The file stays valid as long as the resolver.
  const SourceFile* resolve(const SourceFile& from, const IncludeDirective& include);
  // The file that diagnostics call `name`; null: none.
  const SourceFile* find(std::string_view name) const;
  // The text of the file that diagnostics call `name`: one of those, or a virtual file that the source names by
  // #line "name"; empty: none.
  std::string_view textOf(std::string_view name) const;
  // Every file found so far and the root.
  std::vector<const SourceFile*> files() const;
  // Where resolve looks, in order, for an error message.
  std::vector<std::string> searchedPlaces(const SourceFile& from, bool quoted) const;

 private:
  // Where a quoted include is looked for on disk; nothing: nowhere.
  std::optional<std::filesystem::path> folderOnDisk(const SourceFile& from) const;
  const SourceFile* inVirtualFiles(const std::string& name);
  const SourceFile* inLibrary(const std::string& name);
  const SourceFile* onDisk(const std::filesystem::path& path, const std::string& libraryPath);
  const SourceFile* keep(SourceFile file);

  const Source& source_;
  const CompilerOptions& options_;
  std::span<const EmbeddedFile> library_;
  SourceFile root_;
  std::map<std::string, SourceFile, std::less<>> files_;  // by SourceFile::name
};

}  // namespace quintet::shader
#endif
