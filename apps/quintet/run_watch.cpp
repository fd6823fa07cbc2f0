#include "run_watch.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "diagnostics_view.h"
#include "hang.h"
#include "run_pictures.h"
#include "shader/watch.h"
#include "signals.h"
#include "standard_error.h"
#include "values.h"

namespace quintet::app {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

constexpr double kSignalSeconds = 0.25;  // a signal that comes just before the wait is seen so soon

// Seconds since the latest of the files was written; 0 if they are gone or their times make no sense.
double secondsSinceSave(const Files& files) {
  constexpr double kPlausible = 600;
  double least = kPlausible;
  for (const fs::path& file : files) {
    std::error_code failed;
    const auto time = fs::last_write_time(file, failed);
    const double age = std::chrono::duration<double>(fs::file_time_type::clock::now() - time).count();
    if (!failed && age >= 0) least = std::min(least, age);
  }
  return least < kPlausible ? least : 0;
}

std::string namesOf(const Files& files) {
  std::string names;
  for (const fs::path& file : files) names += (names.empty() ? "" : ", ") + file.filename().string();
  return plain(names);
}

class Watching {
 public:
  Watching(Session& session, const RunOptions& options) : session_(session), options_(options) {}

  int run() {
    session_.prepare();
    session_.openDevice();
    session_.loadScene();
    bool good = link();
    const GracefulStop stop;
    while (true) {
      watchFiles();
      if (good) draw(stop);
      const Files changed = waitForChange(stop);
      if (changed.empty()) break;
      saved_ = changed;
      savedSeconds_ = secondsSinceSave(changed);
      sinceSave_ = Stopwatch();
      good = rebuild(changed);
      if (stop.requested()) break;
    }
    session_.progress().clear();
    return hasPicture_ ? (interrupted_ ? stop.exitStatus() : 0) : 1;
  }

 private:
  bool link() {
    try {
      session_.link();
      return true;
    } catch (const render::ProgramError& error) {
      session_.tell(error.diagnostics());
      return false;
    }
  }

  // Only what has changed. False: told what is wrong; the last good picture stays.
  bool rebuild(const Files& changed) {
    try {
      const Files scene = session_.sceneFiles();
      const auto isOfScene = [&](const fs::path& file) { return std::ranges::find(scene, file) != scene.end(); };
      const bool reload = std::ranges::any_of(changed, isOfScene);
      session_.prepare();
      if (reload || !session_.sceneLoaded()) session_.loadScene();
      return link();
    } catch (const FileError& error) {
      session_.tell({asDiagnostic(error)});
    } catch (const UsageError& error) {  // such as --set of a parameter that is no longer there
      session_.progress().clear();
      printError("quintet: {}\n", plain(error.what()));
    }
    return false;
  }

  void watchFiles() {
    std::error_code ignored;
    Files folders;
    const fs::path program = options_.render.program;
    if (fs::is_directory(program, ignored)) folders.push_back(program);
    if (program.filename() == "program.toml")
      folders.push_back(program.has_parent_path() ? program.parent_path() : ".");
    Files files = session_.files();
    if (fs::is_regular_file(program, ignored)) files.push_back(program);
    watcher_.watch(files, folders, isProgramSource);
    if (!told_) session_.progress().note(fmt::format("watching {} files; Ctrl-C ends", files.size()));
    told_ = true;
  }

  void draw(const GracefulStop& stop) {
    PictureHooks hooks;
    hooks.abandon = [this] { return watcher_.pending(); };
    hooks.firstPicture = [this](const std::string& file) { firstPicture(file); };
    PictureEnd end = PictureEnd::complete;
    withoutHanging(session_.program(), options_.render.json,
                   [&] { end = drawPictures(session_, options_, stop, hooks); });
    if (end == PictureEnd::abandoned) return;
    interrupted_ = end == PictureEnd::interrupted;
    session_.report();
  }

  void firstPicture(const std::string& file) {
    hasPicture_ = true;
    if (saved_.empty()) return;
    session_.progress().note(
        fmt::format("{} saved: {} after {:.2f} s", namesOf(saved_), plain(file), savedSeconds_ + sinceSave_.seconds()));
    saved_.clear();
  }

  // Empty: a signal.
  Files waitForChange(const GracefulStop& stop) {
    while (!stop.requested()) {
      Files changed = watcher_.wait(kSignalSeconds);
      if (!changed.empty()) return changed;
    }
    return {};
  }

  Session& session_;
  const RunOptions& options_;
  shader::FileWatcher watcher_;
  Files saved_;              // what the next picture is about
  double savedSeconds_ = 0;  // its age when sinceSave_ began
  Stopwatch sinceSave_;
  bool hasPicture_ = false;
  bool interrupted_ = false;
  bool told_ = false;
};

}  // namespace

int watchProgram(Session& session, const RunOptions& options) { return Watching(session, options).run(); }

}  // namespace quintet::app
