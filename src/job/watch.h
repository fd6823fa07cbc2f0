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

#include "job/engine.h"
#include "job/observer.h"
#include "job/render_job.h"
#include "job/source_watcher.h"

namespace quintet::job {

class LiveJob {
 public:
  // Resolves the request as it is on disk now. Called again for each reload.
  using Resolve = std::function<ResolvedJob()>;

  // `engine` outlives this object. `program`: name, file or folder, as the user gave it; it is watched from now on.
  LiveJob(Engine& engine, std::string program, Resolve resolve);

  // Builds the job again, and watches every file that it has read, and the program's folder for new ones. False: the
  // program does not compile, or a file or the request is wrong; the observer got the errors as diagnostics. The first
  // call throws such errors of files and requests instead.
  bool reload(Observer& observer);

  // Of the last reload that succeeded; null if the program then stopped compiling.
  RenderJob* job() { return job_.get(); }

  SourceWatcher& watcher() { return watcher_; }

 private:
  void build(Observer& observer);
  void watchFiles();

  Engine& engine_;
  const std::string program_;
  const Resolve resolve_;
  SourceWatcher watcher_;
  std::unique_ptr<RenderJob> job_;
  std::shared_ptr<PreparedScene> scene_;
  std::vector<std::filesystem::path> sceneFiles_;  // of the last job
  WatchList list_;                                 // of the last job, and of what failed since
  bool hasRun_ = false;                            // reload() has succeeded or failed once
};

}  // namespace quintet::job
#endif
