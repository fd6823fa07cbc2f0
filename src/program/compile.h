// SPDX-License-Identifier: Apache-2.0
// Compiles every stage of a program to SPIR-V.
#ifndef QUINTET_PROGRAM_COMPILE_H
#define QUINTET_PROGRAM_COMPILE_H

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "program/description/program.h"
#include "program/instrument.h"
#include "shader/compiler.h"
#include "spirv/log_call_data.h"

namespace quintet::program {

inline constexpr std::uint32_t kCallsPerStage = 1u << 16;

// SPIR-V of every stage, or the diagnostics that explain why it is missing.
struct CompiledProgram {
  struct Stage {
    std::string file;
    shader::Stage kind = shader::Stage::rayGeneration;
    std::vector<std::uint32_t> spirv;  // empty if the stage did not compile
    // With Instrumentation::explain: the calls whose data are logged. Call k of stage number i has the number
    // i · kCallsPerStage + k in the log.
    std::vector<spirv::CallSite> calls = {};
  };
  std::vector<Stage> stages;  // one per file that the program uses
  std::vector<Diagnostic> diagnostics;
  std::vector<std::string> outputs;          // names of the optional outputs that the shaders were compiled with
  std::vector<std::filesystem::path> files;  // read from disk in addition to Program::files, for --watch
  std::vector<Hash> fileHashes;              // of the texts of `files`, sorted, without duplicates
  double seconds = 0;                        // wall-clock time of the compilation
  bool ok = false;                           // every stage has SPIR-V

  const Stage& stage(const std::string& file) const;
};

// Returns the path of a file as the user knows it. The compiler has the program's files only in memory and calls them
// "<folder/file>".
std::string userFile(const Program& program, const std::string& file);

// Returns whether a file of the program includes <quintet/…>, directly or through files of the program, or a file that the
// program does not contain, which can do so.
bool usesLibrary(const Program& program, const std::string& file);

// Returns the files of the stages that the program uses, in the order of CompiledProgram::stages.
std::vector<std::string> stageFiles(const Program& program);

// Returns the source of one stage. A stage of the library becomes a file that includes it. `index` is its position in
// CompiledProgram::stages.
shader::Source stageSource(const Program& program, const std::string& file, std::size_t index,
                           const std::vector<std::pair<std::string, std::string>>& defines,
                           Instrumentation instrumentation);

// Gets the program with drafts (shader::Compiler::DraftListener) of the stages that are not complete yet. Its diagnostics, files
// and hashes are empty.
using DraftListener = std::function<void(CompiledProgram draft)>;

// Compiles all stages in parallel. `defines` apply to every stage (features of the scene and the device). `onDraft` is called
// at most once, on any thread, and only if all stages have a draft or are complete before the last one is complete.
CompiledProgram compile(const Program& program, const shader::Compiler& compiler,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        Instrumentation instrumentation = Instrumentation::none, const DraftListener& onDraft = {});

struct PayloadSize {
  std::string stage;    // file
  std::string type;     // GLSL name, such as "HitPayload"
  std::uint64_t bytes;  // in scalar layout; 0 if unknown
};

// Returns the ray payloads that each stage sends (rayPayloadEXT) or receives (rayPayloadInEXT), except those that the
// compiler removed as unused. Type names require SPIR-V with debug information.
std::vector<PayloadSize> payloadSizes(const CompiledProgram& compiled);

}  // namespace quintet::program
#endif
