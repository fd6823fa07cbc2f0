// SPDX-License-Identifier: Apache-2.0
#include "job/watch.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "job/identity.h"

namespace quintet::job {

LiveJob::LiveJob(Engine& engine, std::string program, Resolve resolve)
    : engine_(engine), program_(std::move(program)), resolve_(std::move(resolve)) {
  watchFiles();
}

void LiveJob::watchFiles() {
  list_.addProgram(program_);
  watcher_.watch(list_);
}

bool LiveJob::reload(Observer& observer) {
  const bool isFirst = !std::exchange(hasRun_, true);
  try {
    build(observer);
    watchFiles();
    return true;
  } catch (const ProgramError& error) {
    list_.addDiagnosed(error.diagnostics());
    observer.diagnostics(error.diagnostics());
  } catch (const FileError& error) {
    list_.addFile(error.file());
    watchFiles();
    if (isFirst) throw;
    observer.diagnostics({asDiagnostic(error)});
  } catch (const UsageError& error) {  // such as a value for a parameter that no longer exists
    if (isFirst) throw;
    observer.diagnostics({{Severity::error, "", 0, 0, "", error.what()}});
  }
  watchFiles();
  return false;
}

void LiveJob::build(Observer& observer) {
  ResolvedJob resolved = resolve_();
  const bool sceneChanged = std::ranges::any_of(
      watcher_.changed(), [&](const auto& file) { return std::ranges::find(sceneFiles_, file) != sceneFiles_.end(); });
  if (sceneChanged || (scene_ && scene_->source != resolved.scene)) scene_.reset();
  // Until the job exists, the files of the last one stay: the cause of an error can be among them.
  list_.addFiles(programFiles(resolved));
  list_.addFiles(sourceFiles(resolved.scene));
  watchFiles();
  job_.reset();
  job_ = std::make_unique<RenderJob>(engine_, std::move(resolved), observer, scene_);
  sceneFiles_ = job_->sceneFiles();
  list_ = {};
  list_.addFiles(job_->files());
}

}  // namespace quintet::job
