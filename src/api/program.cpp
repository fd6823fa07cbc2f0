// SPDX-License-Identifier: Apache-2.0
#include "api/impl.h"
#include "check/check.h"
#include "check/scene_facts.h"
#include "program/description/parser.h"
#include "program/lecture/lecture.h"
#include "program/load.h"

namespace quintet {

Program Program::load(const std::string& nameOrPath) {
  Program result;
  result.impl_ = std::make_shared<const Impl>(Impl{program::loadProgram(nameOrPath)});
  return result;
}

namespace {

// Messages name the program.
std::string nameOrDefault(const std::string& name) { return name.empty() ? "program" : name; }

}  // namespace

Program Program::fromSource(std::string_view text, const std::string& name) {
  Program result;
  result.impl_ = std::make_shared<const Impl>(Impl{
      program::parseLecture(std::string(text), nameOrDefault(name) + std::string(program::kLectureExtension), "")});
  return result;
}

Program Program::fromFiles(std::map<std::string, std::string> files, const std::string& name) {
  const auto description = files.find("program.toml");
  if (description == files.end())
    throw UsageError("program '" + nameOrDefault(name) + "': the files contain no program.toml");
  const std::string text = description->second;
  Program result;
  result.impl_ =
      std::make_shared<const Impl>(Impl{program::parseProgram(text, nameOrDefault(name), "", std::move(files))});
  return result;
}

const Program::Impl& Program::impl() const { return requireObject(impl_, "Program"); }
std::vector<std::string> Program::builtIn() { return program::builtInPrograms(); }
std::string Program::name() const { return impl().program.name; }
std::string Program::description() const { return impl().program.description; }

std::vector<ParameterInfo> Program::parameters() const {
  std::vector<ParameterInfo> result;
  for (const program::Parameter& p : impl().program.parameters)
    result.push_back(
        {p.name, std::string(program::typeName(p.type)), program::formatDefault(p), p.min, p.max, p.unit, p.help});
  return result;
}

std::vector<OutputInfo> Program::outputs() const {
  std::vector<OutputInfo> result;
  for (const program::Output& output : impl().program.outputs)
    result.push_back({output.name, output.help, program::outputChannels(output), output.optional});
  return result;
}

std::vector<Diagnostic> checkProgram(const Program& program, const Scene* scene) {
  const shader::Compiler compiler{shader::CompilerOptions{}};
  std::optional<program::SceneFacts> facts;
  if (scene) facts = check::sceneFacts(*scene->impl().scene);
  return check::checkWithOptionalOutputs(program.impl().program, compiler, facts ? &*facts : nullptr,
                                         check::DeviceLimits{})
      .diagnostics;
}

}  // namespace quintet
