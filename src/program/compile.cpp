// SPDX-License-Identifier: Apache-2.0
#include "program/compile.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "program/description/generated_glsl.h"
#include "program/hit_shaders.h"
#include "program/inline_traces.h"
#include "program/lecture/lecture.h"
#include "quintet/shared/explain.h"
#include "shader/include_resolver.h"
#include "spirv/module.h"

namespace quintet::program {
namespace {

constexpr std::uint32_t kMostDataWords = 4096;  // of the data of a call that is logged: 16 KiB

// Adds the messages and files of one stage. Code that stages share (common text, an included file) gives the same message
// in each of them, which is kept once.
void addResult(CompiledProgram& compiled, shader::Result& result) {
  for (Diagnostic& d : result.diagnostics) addUnique(compiled.diagnostics, std::move(d));
  for (const std::filesystem::path& file : result.files)
    if (std::ranges::find(compiled.files, file) == compiled.files.end()) compiled.files.push_back(file);
  compiled.fileHashes.insert(compiled.fileHashes.end(), result.fileHashes.begin(), result.fileHashes.end());
}

// Adds the stores of payloads and callable data to an instrumented stage. A stage with large data is compiled again, so that
// its records have room for them.
void logCalls(const Program& program, CompiledProgram::Stage& stage, std::size_t index, const shader::Source& source,
              const shader::Compiler& compiler) {
  if (stage.spirv.empty()) return;
  const auto log = [&](std::uint32_t words) {
    return spirv::logCallData(stage.spirv, {shared::kExplainDataBefore, shared::kExplainDataAfter, words},
                              static_cast<std::uint32_t>(index) * kCallsPerStage);
  };
  spirv::LoggedCalls logged = log(shared::kExplainDataWords);
  if (const std::uint32_t words = std::min(logged.maxWords, kMostDataWords); words > shared::kExplainDataWords) {
    shader::Source larger = source;
    larger.defines.emplace_back("QUINTET_EXPLAIN_DATA_WORDS", std::to_string(words) + "u");
    if (shader::Result result = compiler.compile(larger); result.ok()) {
      stage.spirv = std::move(result.spirv);
      logged = log(words);
    }
  }
  stage.spirv = std::move(logged.spirv);
  stage.calls = std::move(logged.sites);
  for (spirv::CallSite& call : stage.calls) call.location.file = userFile(program, call.location.file);
}

shader::Stage stageOf(const std::string& file) {
  return *shader::stageOfFile(isLibraryStage(file) ? file.substr(1, file.size() - 2) : file);
}

// The optional outputs that stages with these definitions write.
std::vector<std::string> outputsOf(const Program& program,
                                   const std::vector<std::pair<std::string, std::string>>& defines) {
  std::vector<std::string> outputs;
  for (const std::string& output : optionalOutputs(program))
    if (std::ranges::find(defines, outputMacro(output), &std::pair<std::string, std::string>::first) != defines.end())
      outputs.push_back(output);
  return outputs;
}

// The stages of a program, complete or as drafts. Passes them on when all are known and at least one of them is a draft.
class CollectedDrafts {
 public:
  CollectedDrafts(const std::vector<std::string>& files, std::vector<std::string> outputs,
                  const DraftListener& listener)
      : listener_(listener), incomplete_(files.size()) {
    draft_.outputs = std::move(outputs);
    draft_.ok = true;
    for (const std::string& file : files) draft_.stages.push_back({file, stageOf(file), {}});
  }

  void add(std::size_t stage, std::vector<std::uint32_t> spirv) { set(stage, std::move(spirv), false); }
  void complete(std::size_t stage, const std::vector<std::uint32_t>& spirv) { set(stage, spirv, true); }

 private:
  void set(std::size_t stage, std::vector<std::uint32_t> spirv, bool complete) {
    const std::lock_guard lock(mutex_);
    if (complete) --incomplete_;
    draft_.stages[stage].spirv = std::move(spirv);
    const auto isMissing = [](const CompiledProgram::Stage& known) { return known.spirv.empty(); };
    if (passed_ || incomplete_ == 0 || std::ranges::any_of(draft_.stages, isMissing)) return;
    passed_ = true;
    listener_(draft_);
  }

  const DraftListener& listener_;
  std::mutex mutex_;
  CompiledProgram draft_;
  std::size_t incomplete_;
  bool passed_ = false;
};

}  // namespace

std::vector<std::string> stageFiles(const Program& program) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& file) {
    if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  add(program.rayGeneration);
  for (const MissShader& miss : missShaders(program)) add(miss.file);
  for (const HitGroup& group : program.hitGroups) {
    for (const auto& [ray, shaders] : group.shaders) {
      add(shaders.closestHit);
      add(shaders.anyHit);
      add(shaders.intersection);
    }
  }
  for (const Callable& callable : program.callables) add(callable.file);
  return files;
}

bool usesLibrary(const Program& program, const std::string& file) {
  std::set<std::string> seen{file};
  std::vector<std::string> open{file};
  while (!open.empty()) {
    const auto found = program.files.find(open.back());
    if (found == program.files.end()) return true;
    const std::filesystem::path folder = std::filesystem::path(open.back()).parent_path();
    open.pop_back();
    for (const shader::IncludeDirective& include : shader::findIncludes(found->second)) {
      if (include.name.starts_with("quintet/")) return true;
      // Relative to the including file, else to the folder of the program.
      std::string name = (folder / include.name).lexically_normal().generic_string();
      if (!program.files.contains(name)) name = std::filesystem::path(include.name).lexically_normal().generic_string();
      if (seen.insert(name).second) open.push_back(name);
    }
  }
  return false;
}

shader::Source stageSource(const Program& program, const std::string& file, std::size_t index,
                           const std::vector<std::pair<std::string, std::string>>& defines,
                           Instrumentation instrumentation) {
  shader::Source source;
  const bool library = isLibraryStage(file);
  source.stage = stageOf(file);
  source.text = library ? "#version 460\n#extension GL_EXT_ray_tracing : require\n#include " + file + "\n"
                        : program.files.at(file);
  if (!isHitStage(file))
    source.text = instrumentStage(source.text, source.stage, index, instrumentation, usesLibrary(program, file));
  source.name = program.path(file);
  source.defines = definesOfStages(program, defines, instrumentation);
  source.virtualFiles = generatedFiles(program);
  for (const auto& [name, text] : program.files) source.virtualFiles[program.path(name)] = text;
  return source;
}

std::string userFile(const Program& program, const std::string& file) {
  if (!isLibraryStage(file)) return file;
  const std::string inside = file.substr(1, file.size() - 2);
  const bool own =
      std::ranges::any_of(program.files, [&](const auto& entry) { return program.path(entry.first) == inside; });
  return own ? inside : file;
}

const CompiledProgram::Stage& CompiledProgram::stage(const std::string& file) const {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const Stage& stage) { return stage.file == file; });
  assert(found != stages.end());
  return *found;
}

CompiledProgram compile(const Program& program, const shader::Compiler& compiler,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        Instrumentation instrumentation, const DraftListener& onDraft) {
  const Stopwatch clock;
  if (hasErrors(program.diagnostics)) return {.stages = {}, .diagnostics = program.diagnostics};
  const std::vector<std::string> files = stageFiles(program);
  std::vector<shader::Result> results(files.size());
  CompiledProgram compiled;
  compiled.stages.resize(files.size());
  CollectedDrafts drafts(files, outputsOf(program, defines), onDraft);
  parallelFor(files.size(), [&](std::size_t i) {
    const shader::Source source = stageSource(program, files[i], i, defines, instrumentation);
    if (onDraft) {
      results[i] = compiler.compile(source, [&](std::vector<std::uint32_t> spirv) { drafts.add(i, std::move(spirv)); });
      drafts.complete(i, results[i].spirv);
    } else {
      results[i] = compiler.compile(source);
    }
    if (program.descriptionFile.ends_with(kLectureExtension)) explainLectureNames(results[i].diagnostics, source.stage);
    compiled.stages[i] = {files[i], source.stage, std::move(results[i].spirv)};
    if (instrumentation == Instrumentation::explain) logCalls(program, compiled.stages[i], i, source, compiler);
  });
  compiled.ok = std::ranges::none_of(compiled.stages, [](const auto& stage) { return stage.spirv.empty(); });
  compiled.diagnostics = program.diagnostics;
  compiled.outputs = outputsOf(program, defines);
  for (shader::Result& result : results) addResult(compiled, result);
  std::ranges::sort(compiled.fileHashes);
  compiled.fileHashes.erase(std::unique(compiled.fileHashes.begin(), compiled.fileHashes.end()),
                            compiled.fileHashes.end());
  for (Diagnostic& d : compiled.diagnostics) d.file = userFile(program, d.file);
  compiled.seconds = clock.seconds();
  return compiled;
}

std::vector<PayloadSize> payloadSizes(const CompiledProgram& compiled) {
  std::vector<PayloadSize> sizes;
  for (const CompiledProgram::Stage& stage : compiled.stages) {
    const std::optional<spirv::Module> module = spirv::Module::read(stage.spirv);
    if (!module) continue;
    for (const spirv::Variable& variable : module->variables())
      if (variable.storage == spv::StorageClass::RayPayloadKHR ||
          variable.storage == spv::StorageClass::IncomingRayPayloadKHR)
        sizes.push_back({stage.file, module->types().nameOf(variable.type), module->types().get(variable.type).bytes});
  }
  return sizes;
}

}  // namespace quintet::program
