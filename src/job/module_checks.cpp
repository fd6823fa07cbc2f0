// SPDX-License-Identifier: Apache-2.0
#include "job/module_checks.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/plural.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "check/modules/groups_file.h"
#include "check/modules/stage_groups.h"
#include "check/modules/stage_module.h"
#include "job/device_limits.h"

namespace quintet::job {
namespace {

namespace fs = std::filesystem;

struct ModuleFile {
  std::string path;
  std::string folder;  // of the request; empty for a file
  std::string name;    // relative to that folder
  std::vector<std::uint32_t> words;
  check::ModuleSummary summary;
};

// A stage of a pipeline, before it is optimized.
struct StagePlan {
  const ModuleFile* module = nullptr;
  spirv::EntryPoint entryPoint;
  std::string name;
  std::optional<shader::SpecializationValues> values;
};

bool startsLikeSpirv(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  unsigned char head[4] = {};
  stream.read(reinterpret_cast<char*>(head), 4);
  constexpr unsigned char kLittle[4] = {0x03, 0x02, 0x23, 0x07}, kBig[4] = {0x07, 0x23, 0x02, 0x03};
  return stream && (std::memcmp(head, kLittle, 4) == 0 || std::memcmp(head, kBig, 4) == 0);
}

// The SPIR-V files in a folder and its subfolders, except hidden ones and links to folders.
void collectModules(const fs::path& folder, std::vector<fs::path>& found) {
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const fs::path& path = entry.path();
    if (path.filename().string().starts_with('.')) continue;
    if (entry.is_directory(failed)) {
      if (!entry.is_symlink(failed)) collectModules(path, found);
    } else if (entry.is_regular_file(failed) && startsLikeSpirv(path)) {
      found.push_back(path);
    }
  }
}

Diagnostic errorIn(const std::string& file, std::string text) {
  Diagnostic d;
  d.severity = Severity::error;
  d.file = file;
  d.text = std::move(text);
  return d;
}

class ModuleSet {
 public:
  explicit ModuleSet(const std::vector<std::string>& names, std::vector<Diagnostic>& problems) {
    for (const std::string& name : names) add(name, problems);
  }

  const std::vector<ModuleFile>& files() const { return files_; }

  // Finds a module by its name in a folder of the request, its path, or its file name if only one has it.
  const ModuleFile* find(const std::string& name) const {
    for (const ModuleFile& file : files_)
      if (file.name == name || file.path == name) return &file;
    const ModuleFile* found = nullptr;
    for (const ModuleFile& file : files_) {
      if (fs::path(file.path).filename() != name) continue;
      if (found) return nullptr;
      found = &file;
    }
    return found;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const ModuleFile& file : files_) result.push_back(file.name);
    return result;
  }

 private:
  void add(const std::string& name, std::vector<Diagnostic>& problems) {
    std::error_code failed;
    if (!fs::is_directory(name, failed)) return addFile(name, "", name, problems);
    std::vector<fs::path> found;
    collectModules(name, found);
    std::ranges::sort(found);
    if (found.empty())
      problems.push_back(errorIn(name, "the folder contains no SPIR-V file; compile the shaders to SPIR-V first"));
    for (const fs::path& path : found)
      addFile(path.string(), name, fs::relative(path, name, failed).generic_string(), problems);
  }

  void addFile(const std::string& path, const std::string& folder, const std::string& name,
               std::vector<Diagnostic>& problems) {
    try {
      const std::vector<std::byte> bytes = readFile(path);
      ModuleFile file{path, folder, name, check::moduleWords(path, bytes), {}};
      std::string why;
      auto summary = check::summarize(file.words, why);
      if (!summary) return problems.push_back(errorIn(path, fmt::format("this is not a valid SPIR-V module: {}", why)));
      file.summary = std::move(*summary);
      if (file.summary.entryPoints.empty() && folder.empty())
        return problems.push_back(errorIn(path, "the module has no entry point of a ray tracing stage"));
      files_.push_back(std::move(file));
    } catch (const FileError& error) {
      problems.push_back(asDiagnostic(error));
    }
  }

  std::vector<ModuleFile> files_;
};

// "lib.spv#name"; "lib.spv#main (miss)" if entry points of different stages have the same name, as those of Slang.
std::string stageName(const ModuleFile& module, const spirv::EntryPoint& entry) {
  const std::vector<spirv::EntryPoint>& all = module.summary.entryPoints;
  if (all.size() < 2) return module.path;
  const std::string name = module.path + "#" + entry.name;
  return std::ranges::count(all, entry.name, &spirv::EntryPoint::name) < 2
             ? name
             : fmt::format("{} ({})", name, shader::stageName(*check::stageOf(entry.stage)));
}

// Finds the stages of a described pipeline, and names them by their files.
class StageFinder {
 public:
  StageFinder(const fs::path& file, const ModuleSet& modules, const check::DescribedPipeline& pipeline)
      : file_(file), modules_(modules), pipeline_(pipeline) {}

  std::vector<StagePlan> find(check::PipelineGroups& groups) {
    using shader::Stage;
    for (std::string& stage : groups.rayGenerations) {
      auto data = groups.recordData.rayGeneration.extract(stage);
      resolve(stage, Stage::rayGeneration);
      if (data.empty()) continue;
      data.key() = stage;
      groups.recordData.rayGeneration.insert(std::move(data));
    }
    for (program::MissShader& miss : groups.misses) resolve(miss.file, Stage::miss);
    for (program::Callable& callable : groups.callables) resolve(callable.file, Stage::callable);
    for (program::HitGroup& group : groups.hitGroups)
      for (auto& [ray, shaders] : group.shaders) {
        resolve(shaders.closestHit, Stage::closestHit);
        resolve(shaders.anyHit, Stage::anyHit);
        resolve(shaders.intersection, Stage::intersection);
      }
    return std::move(plans_);
  }

 private:
  // Replaces the name of the groups file by that of the stage.
  void resolve(std::string& stage, shader::Stage kind) {
    if (stage.empty()) return;
    const check::StageName& name = pipeline_.stages.at(stage);
    const ModuleFile* module = modules_.find(name.module);
    if (!module)
      throw FileError(file_, name.pointer,
                      fmt::format("no module is named '{}'{}", printable(name.module),
                                  suggestionOrList(name.module, modules_.names())));
    const spirv::EntryPoint entry = entryPoint(*module, name, kind);
    stage = stageName(*module, entry);
    if (std::ranges::find(plans_, stage, &StagePlan::name) != plans_.end()) return;
    const auto values = pipeline_.specialization.find(name.module);
    plans_.push_back({module, entry, stage,
                      values == pipeline_.specialization.end() ? std::nullopt : std::optional(values->second)});
  }

  spirv::EntryPoint entryPoint(const ModuleFile& module, const check::StageName& name, shader::Stage kind) const {
    std::vector<spirv::EntryPoint> fitting;
    std::vector<std::string> all;
    for (const spirv::EntryPoint& entry : module.summary.entryPoints) {
      all.push_back(fmt::format("{} ({})", entry.name, shader::stageName(*check::stageOf(entry.stage))));
      if (check::stageOf(entry.stage) == kind && (name.entryPoint.empty() || entry.name == name.entryPoint))
        fitting.push_back(entry);
    }
    if (fitting.size() == 1) return fitting.front();
    throw FileError(file_, name.pointer,
                    fmt::format("'{}' has {} {} shader{}; its entry points are: {}", printable(name.module),
                                fitting.empty() ? "no" : "more than one", shader::stageName(kind),
                                name.entryPoint.empty() ? "" : fmt::format(" '{}'", printable(name.entryPoint)),
                                fmt::join(all, ", ")));
  }

  const fs::path& file_;
  const ModuleSet& modules_;
  const check::DescribedPipeline& pipeline_;
  std::vector<StagePlan> plans_;
};

std::vector<check::ModuleStage> stagesOf(const std::vector<StagePlan>& plans) {
  std::vector<check::ModuleStage> stages(plans.size());
  parallelFor(plans.size(), [&](std::size_t i) {
    stages[i] = check::stageModule(plans[i].name, plans[i].module->words, plans[i].entryPoint, plans[i].values);
  });
  return stages;
}

void checkPipeline(ProgramReport& report, check::PipelineGroups groups, const std::vector<StagePlan>& plans,
                   const std::vector<check::ModuleStage>& stages, const check::DeviceLimits& limits, bool describe) {
  report.result = check::checkModules(groups, stages, limits);
  for (const StagePlan& plan : plans) {
    report.sources.insert(plan.module->summary.sources.begin(), plan.module->summary.sources.end());
    report.files.emplace_back(plan.module->path);
  }
  report.result.suppressed = check::Suppressions(report.sources).apply(report.result.diagnostics);
  for (const check::ModuleStage& stage : stages) {
    if (stage.problem.empty()) continue;
    Diagnostic d = errorIn(stage.name, (stage.malformed ? "this is not a valid SPIR-V module: "
                                                        : "not checked, because SPIRV-Tools cannot process it: ") +
                                           printable(stage.problem));
    if (!stage.malformed) d.severity = Severity::note;
    report.result.diagnostics.push_back(std::move(d));
  }
  if (describe) report.model = check::describeModules(report.name, std::move(groups), stages, report.result);
}

class ModuleChecks {
 public:
  ModuleChecks(const ModuleCheckRequest& request, CheckObserver& observer)
      : request_(request),
        observer_(observer),
        limits_(request.device.empty() ? check::DeviceLimits{} : limitsOfDevice(request.device)) {}

  CheckReport run() {
    std::vector<Diagnostic> problems;
    const ModuleSet modules(request_.modules, problems);
    if (!problems.empty()) {
      ProgramReport& report = start(request_.modules.front());
      report.result.diagnostics = std::move(problems);
      observer_.finished(all_);
    }
    if (!request_.groups.empty())
      checkDescribed(modules);
    else
      checkFolders(modules);
    return std::move(all_);
  }

 private:
  ProgramReport& start(const std::string& name) {
    observer_.started(name);
    ProgramReport& report = all_.programs.emplace_back();
    report.name = name;
    return report;
  }

  void checkDescribed(const ModuleSet& modules) {
    std::vector<check::DescribedPipeline> pipelines;
    try {
      pipelines = check::parseGroups(request_.groups, readTextFile(request_.groups));
    } catch (const FileError& error) {
      ProgramReport& report = start(request_.groups.string());
      report.result.diagnostics.push_back(asDiagnostic(error));
      observer_.finished(all_);
      return;
    }
    for (check::DescribedPipeline& pipeline : pipelines) {
      ProgramReport& report = start(pipeline.name.empty() ? request_.groups.string() : pipeline.name);
      try {
        check::PipelineGroups groups = pipeline.groups;
        const std::vector<StagePlan> plans = StageFinder(request_.groups, modules, pipeline).find(groups);
        checkPipeline(report, std::move(groups), plans, stagesOf(plans), limits_, request_.describe);
      } catch (const FileError& error) {
        report.result.diagnostics.push_back(asDiagnostic(error));
      }
      report.files.push_back(request_.groups);
      observer_.finished(all_);
    }
  }

  // The modules in each folder, and the files of the request, are one pipeline.
  void checkFolders(const ModuleSet& modules) {
    std::map<std::string, std::vector<StagePlan>> folders;
    for (const ModuleFile& module : modules.files()) {
      const std::string folder = module.folder.empty() ? "" : fs::path(module.path).parent_path().string();
      for (const spirv::EntryPoint& entry : module.summary.entryPoints)
        folders[folder].push_back({&module, entry, stageName(module, entry), {}});
    }
    for (const auto& [folder, plans] : folders) {
      const std::vector<check::ModuleStage> stages = stagesOf(plans);
      ProgramReport& report = start(!folder.empty() ? folder : plans.size() == 1 ? plans[0].name : "modules");
      checkPipeline(report, check::groupsOfStages(stages), plans, stages, limits_, request_.describe);
      observer_.finished(all_);
    }
  }

  const ModuleCheckRequest& request_;
  CheckObserver& observer_;
  const check::DeviceLimits limits_;
  CheckReport all_;
};

}  // namespace

CheckReport checkModuleFiles(const ModuleCheckRequest& request, CheckObserver& observer) {
  return ModuleChecks(request, observer).run();
}

}  // namespace quintet::job
