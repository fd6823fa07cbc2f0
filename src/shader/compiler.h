// SPDX-License-Identifier: Apache-2.0
// Compiles GLSL to SPIR-V at run time, with includes from the embedded shader library, diagnostics that point into
// the user's files, and a content-addressed cache. A shader that does not compile is a normal result, not an
// exception.
#ifndef QUINTET_SHADER_COMPILER_H
#define QUINTET_SHADER_COMPILER_H

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "base/diagnostic.h"
#include "base/hash.h"
#include "shader/source.h"
#include "shader/specialization.h"

namespace quintet::shader {

struct Result {
  std::vector<std::uint32_t> spirv;  // empty if the source did not compile
  std::vector<Diagnostic> diagnostics;
  std::vector<std::filesystem::path> files;  // files on disk that were read, other than Source::text; for --watch
  std::vector<Hash> fileHashes;              // of the compiled texts of `files`, in the same order
  bool fromCache = false;
  bool shipped = false;  // made from a module of CompilerOptions::shipped
  bool ok() const { return !spirv.empty(); }
};

class Compiler {
 public:
  explicit Compiler(const CompilerOptions& options);
  ~Compiler();
  Compiler(Compiler&&) noexcept;
  Compiler& operator=(Compiler&&) noexcept;

  // Gets a module that is only reduced (shader::draft), while the complete one is still being made.
  using DraftListener = std::function<void(std::vector<std::uint32_t> spirv)>;

  // Thread-safe. Never throws because of the source. `onDraft` is called at most once, on the thread of the caller, and only
  // if the optimization takes much longer than a draft: for large modules that are not in the cache. The optimization
  // continues on a different thread meanwhile.
  Result compile(const Source& source, const DraftListener& onDraft = {}) const;

  // The optimizations of `compile`, for modules that were changed after a compilation without them (Source::optimize).
  // Thread-safe; uses the cache. Throws Error if the module is invalid.
  std::vector<std::uint32_t> optimize(const std::vector<std::uint32_t>& words) const;

  // The key of the module that ship() makes of `source`.
  Hash shippedKey(const Source& source) const;

  // Compiles `source` for CompilerOptions::shipped: a module for all values of its definitions of features. Throws Error if the
  // compiler has a message, or if the key does not cover an included file.
  ShippedModule ship(const Source& source) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::shader
#endif
