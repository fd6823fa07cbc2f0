#include "shader/glslang_run.h"

#include <algorithm>
#include <functional>

#include <shaderc/shaderc.hpp>

#include "shader/diagnostics.h"

namespace quintet::shader {
namespace {

constexpr std::size_t kMaxIncludeDepth = 64;
constexpr std::size_t kMaxIncludes = 4096;  // two includes in each of 30 files would make 2^30

shaderc_shader_kind kindOf(Stage stage) {
  switch (stage) {
    case Stage::rayGeneration: return shaderc_raygen_shader;
    case Stage::intersection: return shaderc_intersection_shader;
    case Stage::anyHit: return shaderc_anyhit_shader;
    case Stage::closestHit: return shaderc_closesthit_shader;
    case Stage::miss: return shaderc_miss_shader;
    case Stage::callable: return shaderc_callable_shader;
    case Stage::compute: break;
  }
  return shaderc_compute_shader;
}

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  std::string result;
  for (const std::string& part : parts) result.append(result.empty() ? "" : separator).append(part);
  return result;
}

// glslang's callbacks. It asks twice for a quoted name that is not found: once as "x", once as <x>.
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
    std::string_view name;  // empty: `text` is the error message
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
    const SourceFile* file = files_.resolve(*from, include);
    if (!file) {
      if (!include.quoted) noteMissing(*from, include);  // a quoted one is asked for again, as <x>
      missedQuoted_ = include.quoted ? include.name : "";
      return fail(answer, "file not found");
    }
    run_.includes.emplace_back(from->name, file->name);
    answer.name = file->name;
    answer.text = file->text;
  }

  // "includes nest deeper than 64: a.glsl -> b.glsl -> a.glsl (…)": the tail of the chain up to its repetition.
  std::string tooDeep(const IncludeDirective& include) const {
    std::vector<std::string> cycle{chain_.back()};
    for (std::size_t k = chain_.size() - 1; k-- > 0 && cycle.size() < 8;) {
      cycle.insert(cycle.begin(), chain_[k]);
      if (chain_[k] == chain_.back()) break;
    }
    const bool repeats = cycle.size() > 1 && cycle.front() == cycle.back();
    return "includes nest deeper than 64: " + joined(cycle, " -> ") + (repeats ? " (add include guards)" : "") +
           ", then " + std::string(include.name);
  }

  void noteMissing(const SourceFile& from, const IncludeDirective& include) {
    Diagnostic note{.severity = Severity::note, .file = from.name, .line = 0, .column = 0, .id = "GLSL", .text = {}};
    note.text = "'" + std::string(include.name) + "' was searched for in " +
                joined(files_.searchedPlaces(from, missedQuoted_ == include.name), ", ");
    run_.diagnostics.push_back(std::move(note));
  }

  IncludeResolver& files_;
  GlslangRun& run_;
  std::vector<std::string> chain_;  // names of the files that are open, outermost first
  std::string missedQuoted_;
};

shaderc::CompileOptions optionsFor(const Source& source, const CompilerOptions& options) {
  shaderc::CompileOptions result;
  result.SetTargetEnvironment(shaderc_target_env_vulkan, shaderc_env_version_vulkan_1_3);
  result.SetTargetSpirv(shaderc_spirv_version_1_6);
  // Other versions, or none, make glslang 12 print its own built-ins to standard output.
  result.SetForcedVersionProfile(460, shaderc_profile_core);
  result.SetOptimizationLevel(options.optimize ? shaderc_optimization_level_performance
                                               : shaderc_optimization_level_zero);
  if (options.debugInfo) result.SetGenerateDebugInfo();
  for (const auto& [name, value] : source.defines) result.AddMacroDefinition(name, value);
  return result;
}

}  // namespace

GlslangRun runGlslang(const shaderc::Compiler& compiler, const Source& source, const CompilerOptions& options,
                      IncludeResolver& files) {
  GlslangRun run;
  shaderc::CompileOptions glslangOptions = optionsFor(source, options);
  glslangOptions.SetIncluder(std::make_unique<Includer>(files, run));
  const shaderc::SpvCompilationResult result = compiler.CompileGlslToSpv(
      source.text.data(), source.text.size(), kindOf(source.stage), files.root().name.c_str(), "main", glslangOptions);

  std::vector<Diagnostic> diagnostics = parseMessages(result.GetErrorMessage(), files);
  diagnostics.insert(diagnostics.end(), run.diagnostics.begin(), run.diagnostics.end());
  dropConsequences(diagnostics);
  run.diagnostics = std::move(diagnostics);
  if (result.GetCompilationStatus() == shaderc_compilation_status_success)
    run.spirv.assign(result.begin(), result.end());
  const auto isError = [](const Diagnostic& d) { return d.severity == Severity::error; };
  if (run.spirv.empty() && std::ranges::none_of(run.diagnostics, isError))
    run.diagnostics.push_back(
        {Severity::error, files.root().name, 0, 0, "GLSL", "the compiler failed without a message"});
  return run;
}

}  // namespace quintet::shader
