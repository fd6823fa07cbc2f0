// SPDX-License-Identifier: Apache-2.0
// Re-renders a program whenever one of its files is saved. Device, scene and acceleration structures stay as long as the
// files of the scene do not change.
#ifndef QUINTET_JOB_WATCH_H
#define QUINTET_JOB_WATCH_H

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "job/engine.h"
#include "job/observer.h"
#include "job/render_job.h"
#include "shader/file_watcher.h"

namespace quintet::job {

class LiveJob {
 public:
  // Resolves the request as it is on disk now. Called again for each reload.
  using Resolve = std::function<ResolvedJob()>;

  // `engine` outlives this object. `program`: name, file or folder, as the user gave it.
  LiveJob(Engine& engine, std::string program, Resolve resolve)
      : engine_(engine), program_(std::move(program)), resolve_(std::move(resolve)) {}

  // Builds the job again. False: the program does not compile, or a file or the request is wrong; the observer got the errors
  // as diagnostics. The first call throws such errors of files and requests instead.
  bool reload(Observer& observer);

  // Of the last reload that succeeded; null if the program then stopped compiling.
  RenderJob* job() { return job_.get(); }

  // Watches every file that the job has read, and the program's folder for new ones. Returns their number.
  std::size_t watchFiles();
  // True if a file was saved since the last waitForChange(). Does not block.
  bool changePending() { return watcher_.pending(); }
  // Waits up to `seconds` for a save. Empty: nothing was saved.
  std::vector<std::filesystem::path> waitForChange(double seconds);

  // Names of the files of the last change, and the time since they were written, seconds.
  std::string changedNames() const;
  double secondsSinceChange() const { return changeAge_ + sinceChange_.seconds(); }

 private:
  Engine& engine_;
  const std::string program_;
  const Resolve resolve_;
  shader::FileWatcher watcher_;
  std::unique_ptr<RenderJob> job_;
  std::shared_ptr<PreparedScene> scene_;
  std::vector<std::filesystem::path> sceneFiles_, files_;  // of the last job
  std::vector<std::filesystem::path> changed_;
  double changeAge_ = 0;  // seconds between the save and its detection
  Stopwatch sinceChange_;
  bool hasRun_ = false;  // reload() has succeeded or failed once
};

}  // namespace quintet::job
#endif
