// SPDX-License-Identifier: Apache-2.0
// Runs a session in a thread, so that rendering never blocks the window: commands go in, immutable snapshots come out.
#ifndef QUINTET_VIEWER_SESSION_THREAD_H
#define QUINTET_VIEWER_SESSION_THREAD_H

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/stopwatch.h"
#include "io/image.h"
#include "job/depth_map.h"
#include "job/engine.h"
#include "job/interactive/session.h"
#include "job/source_watcher.h"
#include "program/description/program.h"
#include "viewer/snapshot.h"

namespace quintet::viewer {

struct Message {
  enum class Kind { note, warning, error };
  Kind kind = Kind::note;
  std::string text;
};

// What to do with the surface at a pixel.
enum class PickUse {
  select,
  focus,  // SetOrbitCenter
};

class SessionThread {
 public:
  struct Options {
    job::EngineOptions engine;
    std::function<void()> onChange;                        // called from the thread after each new snapshot
    std::function<void(const std::string& json)> onEvent;  // gets the events as lines of JSON; may be empty
  };
  explicit SessionThread(Options options);
  // Interrupts the work. If the device hangs, its objects are leaked.
  ~SessionThread();
  SessionThread(const SessionThread&) = delete;
  SessionThread& operator=(const SessionThread&) = delete;

  // Each of these returns at once. Errors become messages.
  // Replaces the session. If its program has errors or hangs, it tries again after each save of the program's files. The
  // same holds for the command SetProgram, until a different command edits the session. `script`: lines with commands
  // (docs/viewer.md) that follow; those that fail become messages.
  void open(job::interactive::SessionRequest request, std::vector<std::string> script = {});
  // Phase::failed with this error, as if open() had failed: the next save of a file of the program opens it.
  void openAfterSave(job::interactive::SessionRequest request, std::vector<std::string> script, std::string error,
                     std::vector<Diagnostic> diagnostics);
  void retry();                                   // after Phase::failed: opens the same again
  void apply(job::interactive::Command command);  // without a session it has no effect
  void pick(uvec2 pixel, PickUse use);
  void save(const std::filesystem::path& file);  // the shown output, as soon as it has its full size
  // Snapshot::explanation becomes that of this sample. A later call replaces those that wait.
  void explain(uvec2 pixel, std::uint32_t sample);
  void showDepth(bool shown);  // Snapshot::depth

  // Since the last sign of life of the work in progress, which is between two launches; 0 while nothing is done.
  double blockedSeconds() const;
  // A file of the program was saved, but the work does not notice it, because a launch does not end.
  bool savedWhileBlocked();

  std::shared_ptr<const Snapshot> snapshot() const;
  std::vector<Message> takeMessages();
  // The instances that PickUse::select found since the last call; unset for a pixel without a surface.
  std::vector<std::optional<job::interactive::Pick>> takePicks();

 private:
  struct PickRequest {
    uvec2 pixel{0};
    PickUse use = PickUse::select;
  };
  struct SaveRequest {
    std::filesystem::path file;
  };
  struct ExplainRequest {
    uvec2 pixel{0};
    std::uint32_t sample = 0;
  };
  struct DepthRequest {
    bool shown = false;
  };
  struct OpenRequest {
    job::interactive::SessionRequest session;
    std::vector<std::string> script;
  };
  struct WaitForSaveRequest {
    OpenRequest open;
    std::string error;
    std::vector<Diagnostic> diagnostics;
  };
  struct RetryRequest {};
  using Request = std::variant<OpenRequest, job::interactive::Command, PickRequest, SaveRequest, ExplainRequest,
                               DepthRequest, WaitForSaveRequest, RetryRequest>;
  class Host;

  void run();
  void post(Request request);
  bool waitForWork();
  std::vector<Request> takeRequests();
  void handle(Request& request);
  void dispatch(Request& request);
  void retryAfterSave(const Request& request, const std::vector<Diagnostic>& diagnostics);
  void openSession(OpenRequest request);
  void runScript(const std::vector<std::string>& lines);
  void waitForSave(const WaitForSaveRequest& request);
  void retryNow();
  OpenRequest reopening() const;
  void watchSaves();
  void showsLife() { lastSign_ = clock_.seconds(); }
  void closeSession();
  void applyCommand(const job::interactive::Command& command);
  void pickPixel(const PickRequest& request);
  void explainPixel(const ExplainRequest& request);
  void writeSaves();
  void writeSave(const SaveRequest& save);
  void step();
  void updateDepth();
  void measureRays();
  void warnAboutResult();
  void addPrinted(const job::Printed& printed);
  void report(const std::vector<job::interactive::Event>& events);
  void guarded(const std::function<void()>& function);
  void fail(const std::string& error);
  void addMessage(Message::Kind kind, std::string text);
  // Copies the session's state to next_, and publishes. `reloaded`: the files of the program have changed.
  void publishState(bool reloaded = false);
  void publish();  // makes next_ the snapshot

  const Options options_;
  const Stopwatch clock_;

  // Used by the thread only.
  std::unique_ptr<Host> host_;
  std::unique_ptr<job::Engine> engine_;
  std::unique_ptr<job::interactive::Session> session_;
  Snapshot next_;
  std::vector<SaveRequest> saves_;
  std::optional<Request> retry_;  // opens a program that has errors; repeated when one of its files is saved
  std::optional<job::SourceWatcher> retryWatcher_;
  double lastCommand_ = -1e9;                // on clock_
  double lastImage_ = 0;                     // on clock_
  double lastRates_ = 0;                     // on clock_
  std::vector<std::string> resultWarnings_;  // of the last complete image
  std::uint64_t sessions_ = 0;
  std::uint64_t explainedRestarts_ = 0;  // Session::restarts() of next_.explanation
  bool depthShown_ = false;
  bool depthFailed_ = false;   // for this view
  double depthSeconds_ = 1e9;  // that the last depths took

  std::atomic<bool> stop_ = false;
  std::atomic<bool> hasRequests_ = false;
  std::atomic<bool> urgent_ = false;  // a request changes the samples
  std::atomic<bool> hung_ = false;
  std::atomic<bool> working_ = false;
  std::atomic<double> lastSign_ = 0;  // of life, on clock_
  std::mutex savesMutex_;             // of the members for savedWhileBlocked()
  std::optional<job::SourceWatcher> savesWatcher_;
  double lastSave_ = -1e9;  // on clock_
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Request> requests_;
  std::vector<Message> messages_;
  std::vector<std::optional<job::interactive::Pick>> picks_;
  std::shared_ptr<const Snapshot> snapshot_ = std::make_shared<const Snapshot>();
  std::thread thread_;  // last: it uses the members above
};

// Returns whether `next` only overwrites what `last` sets.
bool overwrites(const job::interactive::Command& next, const job::interactive::Command& last);

}  // namespace quintet::viewer
#endif
