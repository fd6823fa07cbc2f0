// SPDX-License-Identifier: Apache-2.0
// A compilation validates the source, finds the files that it can include, looks up the key in the cache, and runs
// glslang only if that fails. The result of spirv-opt, which takes most of the time, has a key of its own, made from the
// output of glslang: programs whose definitions differ often have the same stages. Shaders that the build has compiled only
// get their specialization constants; this is tried first, so that the result does not depend on the caches.
#include "shader/compiler.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <spirv-tools/libspirv.h>
#include <shaderc/shaderc.hpp>

#include "base/error.h"
#include "shader/compiler_messages.h"
#include "shader/deep_stack.h"
#include "shader/include_resolver.h"
#include "shader/library.h"
#include "shader/macro_expansion.h"
#include "shader/optimizer.h"
#include "shader/spirv_cache.h"
#include "shader/stage_builtins.h"
#include "spirv/module.h"
#include "spirv/source_text.h"

namespace quintet::shader {
namespace {

constexpr std::uint64_t kCacheFormat = 1;       // increase it when the options or the layout of an entry change
constexpr std::size_t kMinCachedWords = 16384;  // of a module; spirv-opt takes 20 ms or less for smaller ones
constexpr std::size_t kMinDraftWords = 65536;   // spirv-opt takes 0.2 s or less for smaller ones
constexpr std::size_t kMaxTextBytes = std::size_t{4} << 20;
constexpr std::size_t kMaxFiles = 4096;
constexpr std::size_t kMaxIncludeDepth = 64;
constexpr std::size_t kMaxIncludes = 4096;  // two includes in each of 30 files would make 2^30
constexpr std::size_t kMaxIncludedBytes = std::size_t{64} << 20;

// The files that a compilation can read, found without the preprocessor: a superset of those that it reads.
struct Inputs {
  Hash key;
  std::size_t textBytes = 0;
  std::set<std::pair<std::string, std::string>> includes;  // (including file, included file)
};

void addOptions(Hasher& hasher, const Source& source, const CompilerOptions& options) {
  unsigned spirvVersion = 0, spirvRevision = 0;
  shaderc_get_spv_version(&spirvVersion, &spirvRevision);
  hasher.add(kCacheFormat).add(kOptimizerVersion).add(QUINTET_SHADERC_VERSION).add(spirvVersion).add(spirvRevision);
  hasher.add(static_cast<std::uint64_t>(source.stage)).add(options.optimize && source.optimize).add(options.debugInfo);
  hasher.add(source.defines.size());
  for (const auto& [name, value] : source.defines) hasher.add(name).add(value);
}

// Adds the texts that `source` can read.
void addTexts(Hasher& hasher, Inputs& inputs, IncludeResolver& files) {
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
}

Inputs findInputs(const Source& source, const CompilerOptions& options, IncludeResolver& files) {
  Inputs inputs;
  Hasher hasher;
  addOptions(hasher, source, options);
  addTexts(hasher, inputs, files);
  inputs.key = hasher.finish();
  return inputs;
}

// The same for a module that is shipped. Its key does not contain definitions that no text has, so that stages which differ
// only in those share a module.
Inputs findShippedInputs(Source source, const CompilerOptions& options, IncludeResolver& files) {
  Inputs inputs;
  Hasher texts;
  addTexts(texts, inputs, files);
  const std::vector<const SourceFile*> all = files.files();
  std::erase_if(source.defines, [&](const auto& define) {
    return std::ranges::none_of(
        all, [&](const SourceFile* file) { return file->text.find(define.first) != std::string_view::npos; });
  });
  std::ranges::sort(source.defines);
  Hasher hasher;
  hasher.add("shipped");
  addOptions(hasher, source, options);
  inputs.key = hasher.add(texts.finish().hex()).finish();
  return inputs;
}

int lineNumberAt(std::string_view text, std::size_t position) {
  return 1 + static_cast<int>(std::ranges::count(text.substr(0, position), '\n'));
}

bool isMacroName(std::string_view name) {
  return !name.empty() && !(name.front() >= '0' && name.front() <= '9') &&
         std::ranges::all_of(name, spirv::isWordCharacter);
}

// Returns an error for input that must not reach glslang.
std::optional<Diagnostic> validate(const Source& source, const SourceFile& root) {
  Diagnostic d{Severity::error, root.name, 0, 0, "GLSL", {}};
  if (source.text.size() > kMaxTextBytes) {
    d.text = "shader source is larger than 4 MiB";
    return d;
  }
  if (const std::size_t nul = source.text.find('\0'); nul != std::string::npos) {
    d.line = lineNumberAt(source.text, nul);
    d.text = "shader source contains a NUL byte; check that it is a text file";
    return d;
  }
  for (const auto& [name, value] : source.defines) {
    if (isMacroName(name) && value.find_first_of(std::string_view("\n\r\0", 3)) == std::string::npos) continue;
    d.text = "invalid define '" + name +
             "': the name must consist of letters, digits and '_', the value must be a single line";
    return d;
  }
  return {};
}

// The result of one run of glslang.
struct GlslangRun {
  std::vector<std::uint32_t> spirv;  // empty if it failed
  std::vector<Diagnostic> diagnostics;
  // Includes that the preprocessor followed, as (including file, included file), to check that the cache key covers
  // all of them.
  std::vector<std::pair<std::string, std::string>> includes;
};

shaderc_shader_kind kindOf(Stage stage) {
  switch (stage) {
    case Stage::rayGeneration: return shaderc_raygen_shader;
    case Stage::intersection: return shaderc_intersection_shader;
    case Stage::anyHit: return shaderc_anyhit_shader;
    case Stage::closestHit: return shaderc_closesthit_shader;
    case Stage::miss: return shaderc_miss_shader;
    case Stage::callable: return shaderc_callable_shader;
    case Stage::vertex: return shaderc_vertex_shader;
    case Stage::fragment: return shaderc_fragment_shader;
    case Stage::compute: break;
  }
  return shaderc_compute_shader;
}

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  std::string result;
  for (const std::string& part : parts) result.append(result.empty() ? "" : separator).append(part);
  return result;
}

// Include callbacks of glslang. It requests a quoted name that is not found twice: as "x", then as <x>.
class Includer : public shaderc::CompileOptions::IncluderInterface {
 public:
  Includer(IncludeResolver& files, GlslangRun& run) : files_(files), run_(run) {}

  shaderc_include_result* GetInclude(const char* requested, shaderc_include_type type, const char* requesting,
                                     std::size_t depth) override {
    auto answer = std::make_unique<Answer>();
    fill(*answer, {requested, type == shaderc_include_type_relative}, requesting, depth);
    answer->result.source_name = answer->name.data();
    answer->result.source_name_length = answer->name.size();
    answer->result.content = answer->text.data();
    answer->result.content_length = answer->text.size();
    answer->result.user_data = answer.get();
    return &answer.release()->result;
  }
  void ReleaseInclude(shaderc_include_result* data) override {
    std::unique_ptr<Answer>(static_cast<Answer*>(data->user_data)).reset();
  }

 private:
  struct Answer {
    shaderc_include_result result{};
    std::string_view name;  // empty if `text` is an error message
    std::string_view text;
    std::string message;
  };

  void fail(Answer& answer, std::string message) {
    answer.message = std::move(message);
    answer.text = answer.message;
  }

  void fill(Answer& answer, const IncludeDirective& include, std::string_view requesting, std::size_t depth) {
    const SourceFile* from = files_.find(requesting);
    if (!from) from = &files_.root();
    chain_.resize(std::min(chain_.size(), depth > 0 ? depth - 1 : 0));
    chain_.push_back(from->name);
    if (depth > kMaxIncludeDepth) return fail(answer, tooDeep(include));
    if (run_.includes.size() >= kMaxIncludes) return fail(answer, "more than 4096 includes");
    if (bytes_ > kMaxIncludedBytes) return fail(answer, "more than 64 MiB of included text (add include guards)");
    const SourceFile* file = files_.resolve(*from, include);
    if (!file) {
      if (!include.quoted) noteMissing(*from, include);  // a quoted name is requested again, as <x>
      missedQuoted_ = include.quoted ? include.name : "";
      return fail(answer, "file not found");
    }
    run_.includes.emplace_back(from->name, file->name);
    bytes_ += file->text.size();
    answer.name = file->name;
    answer.text = file->text;
  }

  // The message shows the end of the chain up to its repetition: "a.glsl -> b.glsl -> a.glsl".
  std::string tooDeep(const IncludeDirective& include) const {
    std::vector<std::string> cycle{chain_.back()};
    for (std::size_t k = chain_.size() - 1; k-- > 0 && cycle.size() < 8;) {
      cycle.insert(cycle.begin(), chain_[k]);
      if (chain_[k] == chain_.back()) break;
    }
    const bool repeats = cycle.size() > 1 && cycle.front() == cycle.back();
    return "includes are nested deeper than 64: " + joined(cycle, " -> ") + (repeats ? " (add include guards)" : "") +
           ", then " + std::string(include.name);
  }

  void noteMissing(const SourceFile& from, const IncludeDirective& include) {
    Diagnostic note{.severity = Severity::note, .file = from.name, .line = 0, .column = 0, .id = "GLSL", .text = {}};
    note.text = "searched for '" + std::string(include.name) + "' in " +
                joined(files_.searchedFolders(from, missedQuoted_ == include.name), ", ");
    if (files_.limited()) note.text += "; files outside of the project are not read";
    run_.diagnostics.push_back(std::move(note));
  }

  IncludeResolver& files_;
  GlslangRun& run_;
  std::size_t bytes_ = 0;           // of all included texts
  std::vector<std::string> chain_;  // names of the open files, outermost first
  std::string missedQuoted_;
};

// shaderc does not optimize: optimize() is faster and has a cache of its own.
shaderc::CompileOptions optionsFor(const Source& source, const CompilerOptions& options) {
  shaderc::CompileOptions result;
  result.SetTargetEnvironment(shaderc_target_env_vulkan, shaderc_env_version_vulkan_1_3);
  result.SetTargetSpirv(shaderc_spirv_version_1_6);
  // With any other version, or without one, glslang 12 prints its own built-ins to standard output.
  result.SetForcedVersionProfile(460, shaderc_profile_core);
  result.SetOptimizationLevel(shaderc_optimization_level_zero);
  if (options.debugInfo) result.SetGenerateDebugInfo();
  for (const auto& [name, value] : source.defines) result.AddMacroDefinition(name, value);
  return result;
}

// An error for macros that would take all memory of the machine.
std::optional<Diagnostic> findLargeMacro(const Source& source, const IncludeResolver& files) {
  std::vector<MacroText> texts;
  for (const SourceFile* file : files.files()) texts.push_back({file->name, file->text});
  const std::optional<LargeExpansion> large = findLargeExpansion(texts, source.defines);
  if (!large) return {};
  return Diagnostic{
      .severity = Severity::error,
      .file = large->file,
      .line = large->line,
      .column = 0,
      .id = "GLSL",
      .text = fmt::format("the macro '{}' expands to too much text: the compiler would need more than {} MB "
                          "for more than {} million tokens; use functions and loops",
                          large->macro, kMaxTokens * kTokenBytes / 1e6, kMaxTokens / 1e6)};
}

GlslangRun runGlslang(const shaderc::Compiler& compiler, const Source& source, const CompilerOptions& options,
                      IncludeResolver& files) {
  GlslangRun run;
  if (std::optional<Diagnostic> large = findLargeMacro(source, files)) {
    run.diagnostics.push_back(std::move(*large));
    return run;
  }
  shaderc::CompileOptions glslangOptions = optionsFor(source, options);
  glslangOptions.SetIncluder(std::make_unique<Includer>(files, run));
  const shaderc::SpvCompilationResult result = compiler.CompileGlslToSpv(
      source.text.data(), source.text.size(), kindOf(source.stage), files.root().name.c_str(), "main", glslangOptions);

  std::vector<Diagnostic> diagnostics = parseMessages(result.GetErrorMessage(), files);
  diagnostics.insert(diagnostics.end(), run.diagnostics.begin(), run.diagnostics.end());
  dropFollowUpErrors(diagnostics);
  run.diagnostics = std::move(diagnostics);
  if (result.GetCompilationStatus() == shaderc_compilation_status_success)
    run.spirv.assign(result.begin(), result.end());
  const auto isError = [](const Diagnostic& d) { return d.severity == Severity::error; };
  if (run.spirv.empty() && std::ranges::none_of(run.diagnostics, isError))
    run.diagnostics.push_back(
        {Severity::error, files.root().name, 0, 0, "GLSL", "the compiler failed without a message"});
  return run;
}

GenericSource requireGeneric(const Source& source) {
  std::optional<GenericSource> generic = makeGeneric(source);
  if (!generic) throw Error(source.name + ": the definitions of features differ from those of the renderer");
  return *std::move(generic);
}

// Adds the files on disk that were read.
void addFiles(Result& result, const IncludeResolver& files) {
  for (const SourceFile* file : files.files())
    if (file != &files.root() && !file->diskPath.empty()) {
      result.files.push_back(file->diskPath);
      result.fileHashes.push_back(Hasher().add(file->text).finish());
    }
}

}  // namespace

struct Compiler::Impl {
  explicit Impl(const CompilerOptions& given) : options(given), cache(given.cacheFolder) {
    const char* path = std::getenv("QUINTET_SHADER_PATH");
    if (options.libraryOverride.empty() && path) options.libraryOverride = path;
  }
  // Created on the first cache miss, since it starts glslang.
  const shaderc::Compiler& shadercCompiler() {
    std::call_once(once, [this] { compiler.emplace(); });
    return *compiler;
  }

  std::vector<std::uint32_t> specialized(const Source& source, IncludeResolver& files) const;
  Hash keyOfOptimized(const std::vector<std::uint32_t>& words) const;
  std::vector<std::uint32_t> optimizeWithDraft(const std::vector<std::uint32_t>& words, const DraftListener& onDraft);
  std::vector<std::uint32_t> optimizeAndStore(const std::vector<std::uint32_t>& words, const Hash& key);

  CompilerOptions options;
  SpirvCache cache;
  std::once_flag once;
  std::optional<shaderc::Compiler> compiler;
};

// Returns the SPIR-V of a source that is shipped; empty for others.
std::vector<std::uint32_t> Compiler::Impl::specialized(const Source& source, IncludeResolver& files) const {
  if (options.shipped.empty() || !options.optimize || !source.optimize) return {};
  const std::optional<GenericSource> generic = makeGeneric(source);
  if (!generic) return {};
  const Hash key = findShippedInputs(generic->source, options, files).key;
  std::vector<std::uint32_t> words = findShipped(options.shipped, key);
  if (words.empty()) return {};
  SpecializationValues values;
  Hasher hasher;
  hasher.add("specialize").add(kOptimizerVersion).add(spvSoftwareVersionString()).add(key.hex());
  for (const auto& [id, value] : generic->values) {
    hasher.add(std::uint64_t{id}).add(std::uint64_t{value});
    values[id] = {value};
  }
  const Hash specialization = hasher.finish();
  if (auto entry = cache.load(specialization)) return std::move(entry->spirv);
  words = specialize(words, values);
  cache.store(specialization, {words, {}});
  return words;
}

Hash Compiler::Impl::keyOfOptimized(const std::vector<std::uint32_t>& words) const {
  Hasher hasher;
  hasher.add("optimize").add(kOptimizerVersion).add(spvSoftwareVersionString()).add(options.debugInfo);
  return hasher.add(std::as_bytes(std::span(words))).finish();
}

std::vector<std::uint32_t> Compiler::Impl::optimizeAndStore(const std::vector<std::uint32_t>& words, const Hash& key) {
  std::vector<std::uint32_t> result = shader::optimize(words, options.debugInfo);
  cache.store(key, {result, {}});
  return result;
}

std::vector<std::uint32_t> Compiler::Impl::optimizeWithDraft(const std::vector<std::uint32_t>& words,
                                                             const DraftListener& onDraft) {
  const Hash key = keyOfOptimized(words);
  if (auto entry = cache.load(key)) return std::move(entry->spirv);
  std::future<std::vector<std::uint32_t>> complete =
      std::async(std::launch::async, [&] { return optimizeAndStore(words, key); });
  try {
    onDraft(shader::draft(words));
  } catch (const Error&) {  // the optimization fails for the same reason
  }
  return complete.get();
}

Compiler::Compiler(const CompilerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Compiler::~Compiler() = default;
Compiler::Compiler(Compiler&&) noexcept = default;
Compiler& Compiler::operator=(Compiler&&) noexcept = default;

Result Compiler::compile(const Source& source, const DraftListener& onDraft) const {
  Result result;
  IncludeResolver files(source, impl_->options, embeddedShaderLibrary());
  if (auto problem = validate(source, files.root())) {
    result.diagnostics.push_back(std::move(*problem));
    return result;
  }
  if (std::vector<std::uint32_t> spirv = impl_->specialized(source, files); !spirv.empty()) {
    result.spirv = std::move(spirv);
    result.shipped = true;
    addFiles(result, files);
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
    if (impl_->options.optimize && source.optimize && !run.spirv.empty()) {
      try {
        const bool drafts = onDraft && run.spirv.size() >= kMinDraftWords;
        run.spirv = drafts ? impl_->optimizeWithDraft(run.spirv, onDraft) : optimize(run.spirv);
      } catch (const Error& e) {
        run.spirv.clear();
        run.diagnostics.push_back({Severity::error, files.root().name, 0, 0, "GLSL", e.what()});
      }
    }
    // The key does not cover includes that findIncludes misses, such as those after a comment.
    const bool keyCoversAll =
        std::ranges::all_of(run.includes, [&](const auto& i) { return inputs.includes.contains(i); });
    if (keyCoversAll) impl_->cache.store(inputs.key, {run.spirv, run.diagnostics});
    result.spirv = std::move(run.spirv);
    result.diagnostics = std::move(run.diagnostics);
  }
  explainMissingBuiltIns(result.diagnostics, source.stage);
  explainOutgoingPayload(result.diagnostics, source.stage, files);
  addFiles(result, files);
  return result;
}

Hash Compiler::shippedKey(const Source& source) const {
  const GenericSource generic = requireGeneric(source);
  IncludeResolver files(generic.source, impl_->options, embeddedShaderLibrary());
  return findShippedInputs(generic.source, impl_->options, files).key;
}

ShippedModule Compiler::ship(const Source& source) const {
  const GenericSource generic = requireGeneric(source);
  IncludeResolver files(generic.source, impl_->options, embeddedShaderLibrary());
  const Inputs inputs = findShippedInputs(generic.source, impl_->options, files);
  GlslangRun run;
  runOnDeepStack(stackBytesFor(inputs.textBytes),
                 [&] { run = runGlslang(impl_->shadercCompiler(), generic.source, impl_->options, files); });
  if (!run.diagnostics.empty()) throw Error(run.diagnostics.front().format());
  for (const auto& [from, included] : run.includes)
    if (!inputs.includes.contains({from, included}))
      throw Error(fmt::format("{}: the include of {} was not found before the compilation", from, included));
  return {inputs.key, spirv::withInterfaceNames(shader::optimize(run.spirv, impl_->options.debugInfo))};
}

std::vector<std::uint32_t> Compiler::optimize(const std::vector<std::uint32_t>& words) const {
  if (words.size() < kMinCachedWords) return shader::optimize(words, impl_->options.debugInfo);
  const Hash key = impl_->keyOfOptimized(words);
  if (auto entry = impl_->cache.load(key)) return std::move(entry->spirv);
  return impl_->optimizeAndStore(words, key);
}

}  // namespace quintet::shader
