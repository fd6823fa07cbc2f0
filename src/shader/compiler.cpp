// A compilation: check the source, find every file that it may include, look the key up in the
// cache, and only then start glslang.
#include "shader/compiler.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <set>

#include <shaderc/shaderc.hpp>

#include "shader/diagnostics.h"
#include "shader/embedded_library.h"
#include "shader/glslang_run.h"
#include "shader/spirv_cache.h"
#include "shader/stage_builtins.h"

namespace quintet::shader {
namespace {

constexpr std::uint64_t kCacheFormat = 1;  // to be raised when options or the entry's layout change
constexpr std::size_t kMaxTextBytes = std::size_t{4} << 20;
constexpr std::size_t kMaxFiles = 4096;

// What a compilation may read, found without running the preprocessor: a superset of what it reads.
struct Inputs {
  Hash key;
  std::size_t textBytes = 0;
  std::set<std::pair<std::string, std::string>> includes;  // (including file, included file)
};

void addOptions(Hasher& hasher, const Source& source, const CompilerOptions& options) {
  unsigned spirvVersion = 0, spirvRevision = 0;
  shaderc_get_spv_version(&spirvVersion, &spirvRevision);
  hasher.add(kCacheFormat).add(QUINTET_SHADERC_VERSION).add(spirvVersion).add(spirvRevision);
  hasher.add(static_cast<std::uint64_t>(source.stage)).add(options.optimize).add(options.debugInfo);
  hasher.add(source.defines.size());
  for (const auto& [name, value] : source.defines) hasher.add(name).add(value);
}

Inputs findInputs(const Source& source, const CompilerOptions& options, IncludeResolver& files) {
  Inputs inputs;
  Hasher hasher;
  addOptions(hasher, source, options);
  std::deque<const SourceFile*> open{&files.root()};
  std::set<const SourceFile*> seen{&files.root()};
  while (!open.empty()) {
    const SourceFile& file = *open.front();
    open.pop_front();
    hasher.add(file.name).add(file.text);
    inputs.textBytes += file.text.size();
    for (const IncludeDirective& include : findIncludes(file.text)) {
      const SourceFile* target = seen.size() < kMaxFiles ? files.resolve(file, include) : nullptr;
      hasher.add(target ? target->name : "");
      if (!target) continue;
      inputs.includes.emplace(file.name, target->name);
      if (seen.insert(target).second) open.push_back(target);
    }
  }
  inputs.key = hasher.finish();
  return inputs;
}

int lineOf(std::string_view text, std::size_t position) {
  return 1 + static_cast<int>(std::ranges::count(text.substr(0, position), '\n'));
}

bool isMacroName(std::string_view name) {
  const auto isWord = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
  };
  return !name.empty() && !(name.front() >= '0' && name.front() <= '9') && std::ranges::all_of(name, isWord);
}

// What must not reach glslang.
std::optional<Diagnostic> refusal(const Source& source, const SourceFile& root) {
  Diagnostic d{Severity::error, root.name, 0, 0, "GLSL", {}};
  if (source.text.size() > kMaxTextBytes) {
    d.text = "the source is larger than 4 MiB";
    return d;
  }
  if (const std::size_t nul = source.text.find('\0'); nul != std::string::npos) {
    d.line = lineOf(source.text, nul);
    d.text = "the source holds a NUL byte (is it a text file?)";
    return d;
  }
  for (const auto& [name, value] : source.defines) {
    if (isMacroName(name) && value.find_first_of(std::string_view("\n\r\0", 3)) == std::string::npos) continue;
    d.text = "'" + name + "' cannot be defined: a name of letters, digits and '_', and a value of one line, are needed";
    return d;
  }
  return {};
}

// Deep enough for any source of that size: a level of an expression takes 2 characters ("+a") and
// about 2 KiB of stack. Only touched pages cost memory.
std::size_t stackBytesFor(std::size_t textBytes) {
  return std::min((std::size_t{64} << 20) + textBytes * 1024, std::size_t{1} << 30);
}

}  // namespace

struct Compiler::Impl {
  explicit Impl(const CompilerOptions& given) : options(given), cache(given.cacheFolder) {
    const char* path = std::getenv("QUINTET_SHADER_PATH");
    if (options.libraryOverride.empty() && path) options.libraryOverride = path;
  }
  // Made on the first miss: it starts glslang.
  const shaderc::Compiler& shadercCompiler() {
    std::call_once(once, [this] { compiler.emplace(); });
    return *compiler;
  }

  CompilerOptions options;
  SpirvCache cache;
  std::once_flag once;
  std::optional<shaderc::Compiler> compiler;
};

Compiler::Compiler(const CompilerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Compiler::~Compiler() = default;
Compiler::Compiler(Compiler&&) noexcept = default;
Compiler& Compiler::operator=(Compiler&&) noexcept = default;

Result Compiler::compile(const Source& source) const {
  Result result;
  IncludeResolver files(source, impl_->options, embeddedShaderLibrary());
  if (auto problem = refusal(source, files.root())) {
    result.diagnostics.push_back(std::move(*problem));
    return result;
  }
  const Inputs inputs = findInputs(source, impl_->options, files);
  if (auto entry = impl_->cache.load(inputs.key)) {
    result.spirv = std::move(entry->spirv);
    result.diagnostics = std::move(entry->diagnostics);
    result.fromCache = true;
  } else {
    GlslangRun run;
    const shaderc::Compiler& compiler = impl_->shadercCompiler();
    runOnDeepStack(stackBytesFor(inputs.textBytes), [&] { run = runGlslang(compiler, source, impl_->options, files); });
    // An include that findIncludes does not see (after a comment, say) is not part of the key.
    const bool keyCoversAll =
        std::ranges::all_of(run.includes, [&](const auto& i) { return inputs.includes.contains(i); });
    if (keyCoversAll) impl_->cache.store(inputs.key, {run.spirv, run.diagnostics});
    result.spirv = std::move(run.spirv);
    result.diagnostics = std::move(run.diagnostics);
  }
  explainMissingBuiltIns(result.diagnostics, source.stage);
  explainPayloadOfAnotherStage(result.diagnostics, source.stage, files);
  for (const SourceFile* file : files.files())
    if (file != &files.root() && !file->diskPath.empty()) {
      result.files.push_back(file->diskPath);
      result.fileHashes.push_back(Hasher().add(file->text).finish());
    }
  return result;
}

}  // namespace quintet::shader
