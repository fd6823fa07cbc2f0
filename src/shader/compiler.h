// GLSL to SPIR-V at run time, with includes from the embedded shader library, diagnostics that point
// into the user's files, and a content-addressed cache on disk. A shader that does not compile is a
// normal result, not an exception.
#ifndef QUINTET_SHADER_COMPILER_H
#define QUINTET_SHADER_COMPILER_H

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"

namespace quintet::shader {

enum class Stage { rayGeneration, intersection, anyHit, closestHit, miss, callable, compute };
std::string_view stageName(Stage);       // "ray generation"
std::string_view stageExtension(Stage);  // ".rgen"
std::optional<Stage> stageOfFile(
    const std::filesystem::path& file);  // by extension .rgen .rint .rahit .rchit .rmiss .rcall .comp

enum class Severity { note, warning, error };

struct Diagnostic {
  Severity severity = Severity::error;
  std::string file;  // as the user knows it: a path, or "<quintet/bsdf/ggx.glsl>" for the embedded library
  int line = 0;      // 1-based; 0: unknown
  int column = 0;    // 1-based; 0: unknown
  std::string id;    // "GLSL" for the compiler's own, "Q101" … for the link's
  std::string text;
  std::string format() const;  // "file:line: error: text [id]"
};

struct Source {
  Stage stage = Stage::compute;
  std::string text;  // GLSL 460 (another #version is compiled as 460, with a warning)
  // Path shown in diagnostics; its folder is searched for #include "…". "<programs/x.rgen>": in memory.
  std::string name;
  std::vector<std::pair<std::string, std::string>> defines;
  // Files that exist only in memory, by include name, e.g. "quintet/generated/program.glsl" (brackets
  // around it do not matter); they win over every folder. A quoted include is first tried relative to
  // the including file here too. Diagnostics call them <quintet/generated/program.glsl>.
  std::map<std::string, std::string> virtualFiles;
};

struct Result {
  std::vector<std::uint32_t> spirv;  // empty: did not compile
  std::vector<Diagnostic> diagnostics;
  std::vector<std::filesystem::path> files;  // every file on disk that was read, Source::text's own not (for --watch)
  std::vector<Hash> fileHashes;              // of their texts, as they were compiled; in the same order
  bool fromCache = false;
  bool ok() const { return !spirv.empty(); }
};

struct CompilerOptions {
  // Folder that overrides the embedded library (its quintet/ is looked up first); $QUINTET_SHADER_PATH if empty.
  std::filesystem::path libraryOverride;
  std::vector<std::filesystem::path> includeFolders;  // further folders for #include <…>
  std::filesystem::path cacheFolder;                  // empty: no disk cache
  bool optimize = true;                               // spirv-opt for speed
  bool debugInfo =
      true;  // sources, lines and names in the SPIR-V; the code is the same (spirv_module.h: withoutDebugInfo)
};

class Compiler {
 public:
  explicit Compiler(const CompilerOptions& options);
  ~Compiler();
  Compiler(Compiler&&) noexcept;
  Compiler& operator=(Compiler&&) noexcept;

  // May be called from several threads at once. Never throws for what the source says.
  Result compile(const Source& source) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::shader
#endif
