// SPDX-License-Identifier: Apache-2.0
#include "viewer/session_thread.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "gpu/error.h"
#include "job/interactive/command_json.h"
#include "job/interactive/event_json.h"
#include "job/result.h"
#include "output/plan.h"
#include "output/write.h"
#include "overlay/ray_overlay.h"
#include "viewer/edit_script.h"

namespace quintet::viewer {
namespace {

namespace interactive = job::interactive;

constexpr double kStepSeconds = 0.05;
constexpr double kIdleSeconds = 0.1;    // between checks for saved files of the program
constexpr double kMovingSeconds = 0.3;  // after a command, images of reduced resolution are not interrupted
constexpr double kRateSeconds = 0.25;   // between measurements of the rate of rays, which wait for the device

constexpr double kBlockedSeconds = 5.0;     // without a sign of life, after which a save is not noticed
constexpr double kFastDepthSeconds = 0.02;  // depths that are found in this time follow a moving camera

// The request keeps the samples, so it does not interrupt a batch.
template <class Request>
bool onlyDisplays(const Request& request) {
  const auto* command = std::get_if<interactive::Command>(&request);
  return command && (std::holds_alternative<interactive::SetExposure>(*command) ||
                     std::holds_alternative<interactive::SetToneMap>(*command) ||
                     std::holds_alternative<interactive::EndDrag>(*command));
}

template <class... Kinds>
bool isAny(const interactive::Command& command) {
  return (std::holds_alternative<Kinds>(command) || ...);
}

// Commands that a user gives while correcting a program do not end its retries.
bool endsRetries(const interactive::Command& command) {
  using namespace interactive;
  const auto* size = std::get_if<SetSize>(&command);
  return !isAny<SetExposure, SetToneMap, SetPrint, EndDrag>(command) && !(size && size->ofWindow);
}

}  // namespace

bool overwrites(const interactive::Command& next, const interactive::Command& last) {
  using namespace interactive;
  if (next.index() != last.index()) return false;
  if (isAny<SetSamples, SetToneMap, SetPrint, Rewind>(next)) return true;
  if (isAny<Orbit, Pan, Zoom, interactive::Fly, Move>(next)) return false;  // they add up
  const std::string group = undoGroup(next);
  return !group.empty() && group == undoGroup(last);
}

// Forwards the stages of the work, and remembers that the device hangs.
class SessionThread::Host : public job::Observer {
 public:
  explicit Host(SessionThread& thread) : thread_(thread) {}
  void stage(const std::string& text) override {
    thread_.showsLife();
    thread_.next_.stage = text;
    thread_.publish();
  }
  void warning(const std::string& text) override { thread_.addMessage(Message::Kind::warning, text); }
  void deviceHung(const Diagnostic& diagnostic) override {
    thread_.hung_ = true;
    thread_.next_.diagnostics = {diagnostic};
  }

 private:
  SessionThread& thread_;
};

SessionThread::SessionThread(Options options)
    : options_(std::move(options)), host_(std::make_unique<Host>(*this)), thread_([this] { run(); }) {}

SessionThread::~SessionThread() {
  stop_ = true;
  {
    const std::lock_guard lock(mutex_);
    hasRequests_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void SessionThread::post(Request request) {
  {
    const std::lock_guard lock(mutex_);
    const auto* command = std::get_if<interactive::Command>(&request);
    auto* last = requests_.empty() ? nullptr : std::get_if<interactive::Command>(&requests_.back());
    const auto* explain = std::get_if<ExplainRequest>(&request);
    auto* lastExplain = requests_.empty() ? nullptr : std::get_if<ExplainRequest>(&requests_.back());
    if (command && last && overwrites(*command, *last))
      *last = *command;
    else if (explain && lastExplain)
      *lastExplain = *explain;
    else
      requests_.push_back(std::move(request));
    hasRequests_ = true;
    urgent_ = urgent_ || !onlyDisplays(requests_.back());
  }
  changed_.notify_one();
}

void SessionThread::open(interactive::SessionRequest request, std::vector<std::string> script) {
  post(OpenRequest{std::move(request), std::move(script)});
}
void SessionThread::openAfterSave(interactive::SessionRequest request, std::vector<std::string> script,
                                  std::string error, std::vector<Diagnostic> diagnostics) {
  post(WaitForSaveRequest{{std::move(request), std::move(script)}, std::move(error), std::move(diagnostics)});
}
void SessionThread::retry() { post(RetryRequest{}); }
void SessionThread::apply(interactive::Command command) { post(std::move(command)); }
void SessionThread::pick(uvec2 pixel, PickUse use) { post(PickRequest{pixel, use}); }
void SessionThread::save(const std::filesystem::path& file) { post(SaveRequest{file}); }
void SessionThread::showDepth(bool shown) { post(DepthRequest{shown}); }

void SessionThread::explain(uvec2 pixel, std::uint32_t sample) { post(ExplainRequest{pixel, sample}); }

double SessionThread::blockedSeconds() const { return working_ ? clock_.seconds() - lastSign_ : 0.0; }

bool SessionThread::savedWhileBlocked() {
  const std::lock_guard lock(savesMutex_);
  if (savesWatcher_ && savesWatcher_->pending()) {
    savesWatcher_->wait(0);
    lastSave_ = clock_.seconds() - savesWatcher_->secondsSinceChange();
  }
  return lastSave_ > lastSign_ && blockedSeconds() > kBlockedSeconds;
}

std::shared_ptr<const Snapshot> SessionThread::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

std::vector<Message> SessionThread::takeMessages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

std::vector<std::optional<interactive::Pick>> SessionThread::takePicks() {
  const std::lock_guard lock(mutex_);
  return std::exchange(picks_, {});
}

void SessionThread::addMessage(Message::Kind kind, std::string text) {
  {
    const std::lock_guard lock(mutex_);
    messages_.push_back({kind, std::move(text)});
  }
  if (options_.onChange) options_.onChange();
}

void SessionThread::publish() {
  auto snapshot = std::make_shared<const Snapshot>(next_);
  {
    const std::lock_guard lock(mutex_);
    snapshot_ = std::move(snapshot);
  }
  if (options_.onChange) options_.onChange();
}

// ---- The thread

void SessionThread::run() {
  while (waitForWork()) {
    showsLife();
    working_ = true;
    for (Request& request : takeRequests()) {
      if (stop_) break;
      guarded([&] { handle(request); });
    }
    if (retry_ && !stop_ && retryWatcher_->pending()) {
      retryWatcher_->wait(0);
      Request request = *retry_;
      guarded([&] { handle(request); });
    }
    if (session_ && !stop_) guarded([&] { step(); });
    if (session_ && !next_.stage.empty()) {
      next_.stage.clear();
      publish();
    }
    working_ = false;
  }
  closeSession();
}

// Returns false if the thread must end.
bool SessionThread::waitForWork() {
  std::unique_lock lock(mutex_);
  double seconds = kIdleSeconds;
  if (session_) seconds = std::min(seconds, session_->secondsUntilWork());
  changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return hasRequests_.load(); });
  return !stop_;
}

std::vector<SessionThread::Request> SessionThread::takeRequests() {
  const std::lock_guard lock(mutex_);
  hasRequests_ = false;
  urgent_ = false;
  return std::exchange(requests_, {});
}

void SessionThread::handle(Request& request) {
  const auto* command = std::get_if<interactive::Command>(&request);
  const bool opens = std::holds_alternative<OpenRequest>(request) ||
                     (command && std::holds_alternative<interactive::SetProgram>(*command));
  if (!opens) return dispatch(request);
  retry_.reset();
  const Request original = request;
  try {
    dispatch(request);
  } catch (const ProgramError& error) {
    retryAfterSave(original, error.diagnostics());
    throw;
  } catch (const FileError& error) {
    retryAfterSave(original, {asDiagnostic(error)});
    throw;
  } catch (const UsageError&) {  // such as a value for a parameter that the program does not have yet
    retryAfterSave(original, {});
    throw;
  }
}

void SessionThread::retryAfterSave(const Request& request, const std::vector<Diagnostic>& diagnostics) {
  const auto* open = std::get_if<OpenRequest>(&request);
  job::WatchList files;
  files.addProgram(open ? open->session.program
                        : std::get<interactive::SetProgram>(std::get<interactive::Command>(request)).name);
  files.addDiagnosed(diagnostics);
  if (files.files.empty() && files.folders.empty()) return;
  try {
    retryWatcher_.emplace().watch(std::move(files));
    retry_ = request;
  } catch (const Error& error) {  // the limit of watches
    addMessage(Message::Kind::warning, error.what());
  }
}

void SessionThread::dispatch(Request& request) {
  std::visit(
      [&](auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, OpenRequest>)
          openSession(std::move(value));
        else if constexpr (std::is_same_v<T, WaitForSaveRequest>)
          waitForSave(value);
        else if constexpr (std::is_same_v<T, RetryRequest>)
          retryNow();
        else if constexpr (std::is_same_v<T, interactive::Command>)
          applyCommand(value);
        else if constexpr (std::is_same_v<T, PickRequest>)
          pickPixel(value);
        else if constexpr (std::is_same_v<T, ExplainRequest>)
          explainPixel(value);
        else if constexpr (std::is_same_v<T, DepthRequest>)
          depthShown_ = value.shown;
        else
          saves_.push_back(value);
      },
      request);
}

// Errors end the session if it cannot continue; all others become messages.
void SessionThread::guarded(const std::function<void()>& function) {
  try {
    function();
  } catch (const ProgramError& error) {
    next_.diagnostics = error.diagnostics();
    if (!session_) return fail(error.what());
    addMessage(Message::Kind::error, error.what());
    publish();
  } catch (const TimeoutError& error) {
    const Request again = reopening();
    next_.hung = true;
    retryAfterSave(again, next_.diagnostics);
    fail(error.what());
  } catch (const DeviceLostError& error) {
    if (!session_) {
      fail(error.what());
      engine_.reset();  // its device stays lost
      return;
    }
    if (!session_->recoverFrom(error)) addMessage(Message::Kind::error, error.what());
  } catch (const gpu::NoDeviceError& error) {
    if (!session_) {
      fail(error.what());
      engine_.reset();  // the devices can change
      return;
    }
    addMessage(Message::Kind::error, error.what());
  } catch (const gpu::VulkanError& error) {
    fail(error.what());
  } catch (const std::exception& error) {  // UsageError, FileError, MemoryError, std::bad_alloc
    if (!session_) return fail(error.what());
    addMessage(Message::Kind::error, error.what());
  }
}

void SessionThread::fail(const std::string& error) {
  closeSession();
  saves_.clear();
  next_.phase = Snapshot::Phase::failed;
  next_.stage.clear();
  next_.error = error;
  next_.reopensAfterSave = retry_.has_value();
  next_.image = nullptr;
  publish();
}

void SessionThread::closeSession() {
  if (hung_) {
    // Their destructors would wait for the device.
    static_cast<void>(session_.release());
    static_cast<void>(engine_.release());
    hung_ = false;
  }
  session_.reset();
}

void SessionThread::openSession(OpenRequest opened) {
  interactive::SessionRequest& request = opened.session;
  closeSession();
  saves_.clear();
  next_ = Snapshot{};
  depthFailed_ = false;
  resultWarnings_.clear();
  next_.session = ++sessions_;
  next_.phase = Snapshot::Phase::loading;
  next_.stage = "opening the device";
  publish();
  next_.request = std::make_shared<const interactive::SessionRequest>(request);
  if (!engine_) engine_ = std::make_unique<job::Engine>(options_.engine);
  session_ = std::make_unique<interactive::Session>(
      *engine_, std::move(request), [this] { return clock_.seconds(); }, *host_);
  next_.phase = Snapshot::Phase::ready;
  next_.stage.clear();
  next_.device = engine_->context().info().name;
  next_.scene = std::make_shared<const SceneOutline>(outlineOf(*session_));
  next_.diagnostics = session_->diagnostics();
  lastImage_ = clock_.seconds();
  publishState();
  runScript(opened.script);
}

void SessionThread::runScript(const std::vector<std::string>& lines) {
  for (const std::string& line : lines)
    guarded([&] { applyCommand(interactive::parseCommand(interactive::sessionSchema().readCommand(line))); });
}

void SessionThread::waitForSave(const WaitForSaveRequest& request) {
  closeSession();
  next_ = Snapshot{};
  next_.session = ++sessions_;
  next_.request = std::make_shared<const interactive::SessionRequest>(request.open.session);
  next_.diagnostics = request.diagnostics;
  retryAfterSave(request.open, request.diagnostics);
  fail(request.error);
}

void SessionThread::retryNow() {
  if (session_) return;
  Request again = retry_ ? *retry_ : Request(OpenRequest{*next_.request, {}});
  handle(again);
}

// Opens the scene with all changes of the user, as far as they are known.
SessionThread::OpenRequest SessionThread::reopening() const {
  if (!next_.program) return {*next_.request, {}};
  OpenRequest result{interactive::withState(*next_.request, next_.state), editScript(next_)};
  const std::vector<std::string> display = displayScript(next_);
  result.script.insert(result.script.end(), display.begin(), display.end());
  return result;
}

// For savedWhileBlocked().
void SessionThread::watchSaves() {
  const job::WatchList& files = session_->watchedFiles();
  const std::lock_guard lock(savesMutex_);
  try {
    if (!savesWatcher_) savesWatcher_.emplace();
    const job::WatchList& last = savesWatcher_->watched();
    if (last.files != files.files || last.folders != files.folders) savesWatcher_->watch(files);
  } catch (const Error&) {  // the system's limit of watches
    savesWatcher_.reset();
  }
}

void SessionThread::applyCommand(const interactive::Command& command) {
  if (!session_) return;
  lastCommand_ = clock_.seconds();
  if (endsRetries(command)) retry_.reset();
  session_->apply(command);
  publishState();
}

void SessionThread::publishState(bool reloaded) {
  if (reloaded || !next_.program || next_.state.program != session_->state().program) {
    next_.program = std::make_shared<const program::Program>(session_->program());
    next_.countsFrames = next_.program->accumulation == program::Accumulation::program;
    next_.animated = session_->isAnimated() && !next_.countsFrames;
    next_.diagnostics = session_->diagnostics();
    next_.outdatedProgram = false;
    next_.explanationUsesCamera = false;
  }
  watchSaves();
  next_.explanationOutdated = next_.explanation && session_->restarts() != explainedRestarts_;
  next_.callsPrint = session_->callsPrint();
  next_.print = session_->print();
  next_.state = session_->state();
  next_.parameters = std::make_shared<const program::ParameterValues>(session_->parameters());
  next_.canUndo = session_->canUndo();
  next_.canRedo = session_->canRedo();
  next_.undoName = session_->undoName();
  next_.redoName = session_->redoName();
  next_.camera = session_->camera();
  next_.navigation.reset();
  if (!next_.camera.orthographic) next_.navigation = session_->navigation();
  publish();
}

void SessionThread::pickPixel(const PickRequest& request) {
  if (!session_) return;
  const std::optional<interactive::Pick> found = session_->pick(request.pixel);
  if (request.use == PickUse::select) {
    {
      const std::lock_guard lock(mutex_);
      picks_.push_back(found);
    }
    if (options_.onChange) options_.onChange();
  } else if (found) {
    applyCommand(interactive::SetOrbitCenter{found->position});
  }
}

void SessionThread::explainPixel(const ExplainRequest& request) {
  if (!session_) return;
  next_.explaining = true;
  publishState();
  next_.explaining = false;
  next_.explanation = nullptr;
  try {
    next_.explanation = std::make_shared<const job::PixelExplanation>(session_->explain(request.pixel, request.sample));
  } catch (...) {
    publish();
    throw;
  }
  next_.explanationUsesCamera = overlay::usesCamera(*next_.explanation, session_->camera());
  explainedRestarts_ = session_->restarts();
  if (options_.onEvent) options_.onEvent(interactive::explainedJson(*next_.explanation, ""));
  publishState();
}

void SessionThread::step() {
  // While something moves, each image is shown. Afterwards a batch can take long, and commands interrupt it.
  const bool moving = clock_.seconds() - lastCommand_ < kMovingSeconds;
  const auto interrupted = [&] {
    showsLife();
    return stop_ || (!moving && urgent_);
  };
  const std::vector<interactive::Event> events = session_->step(kStepSeconds, interrupted);
  if (!events.empty()) report(events);
  if (!saves_.empty()) writeSaves();
  updateDepth();
}

// The depths of the view, once. Slow devices wait until nothing moves.
void SessionThread::updateDepth() {
  if (!depthShown_ || !next_.image || !next_.renderError.empty()) {
    if (std::exchange(next_.depth, nullptr)) publish();
    return;
  }
  const bool moving = clock_.seconds() - lastCommand_ < kMovingSeconds;
  if (next_.depth || depthFailed_ || (moving && depthSeconds_ > kFastDepthSeconds)) return;
  const double start = clock_.seconds();
  depthFailed_ = true;  // unless it succeeds
  next_.depth = std::make_shared<const job::DepthMap>(session_->depthMap());
  depthFailed_ = false;
  depthSeconds_ = clock_.seconds() - start;
  publish();
}

void SessionThread::report(const std::vector<interactive::Event>& events) {
  bool image = false, programReloaded = false;
  for (const interactive::Event& event : events) {
    if (options_.onEvent) options_.onEvent(interactive::eventJson(event));
    if (std::holds_alternative<interactive::Restarted>(event)) {
      next_.renderError.clear();
      next_.droppedSamples = 0;
      next_.droppedPixels.clear();
      next_.printed = nullptr;
      next_.depth = nullptr;
      depthFailed_ = false;
    } else if (const auto* updated = std::get_if<interactive::ImageUpdated>(&event)) {
      next_.progress = *updated;
      image = true;
    } else if (const auto* found = std::get_if<interactive::DiagnosticsFound>(&event)) {
      next_.diagnostics = found->diagnostics;
      next_.outdatedProgram = hasErrors(found->diagnostics);
    } else if (const auto* reloaded = std::get_if<interactive::ProgramReloaded>(&event)) {
      programReloaded = true;
      addMessage(Message::Kind::note, fmt::format("reloaded {}", reloaded->files));
    } else if (const auto* lines = std::get_if<interactive::LinesPrinted>(&event)) {
      addPrinted(lines->printed);
    } else if (const auto* replaced = std::get_if<interactive::DeviceReplaced>(&event)) {
      next_.device = replaced->device;
      addMessage(Message::Kind::warning, fmt::format("the device was lost; rendering again on {}", replaced->device));
    } else if (const auto* note = std::get_if<interactive::Note>(&event)) {
      addMessage(Message::Kind::note, note->text);
    } else if (const auto* warning = std::get_if<interactive::Warning>(&event)) {
      addMessage(Message::Kind::warning, warning->text);
    } else if (const auto* failed = std::get_if<interactive::Failed>(&event)) {
      next_.renderError = failed->message;
      addMessage(Message::Kind::error, failed->message);
    }
  }
  if (image) {
    next_.image = std::make_shared<const io::Image>(session_->linearImage());
    ++next_.imageNumber;
    const double now = clock_.seconds();
    next_.secondsPerImage = now - std::exchange(lastImage_, now);
    measureRays();
    if (next_.progress.complete) warnAboutResult();
    for (const program::Output& output : session_->program().outputs)
      if (output.name == session_->state().output) next_.outputKind = output.kind;
  }
  publishState(programReloaded);
}

void SessionThread::addPrinted(const job::Printed& printed) {
  job::Printed all = next_.printed ? *next_.printed : job::Printed();
  all.lines.insert(all.lines.end(), printed.lines.begin(), printed.lines.end());
  all.omitted += printed.omitted;
  all.notStored += printed.notStored;
  next_.printed = std::make_shared<const job::Printed>(std::move(all));
}

void SessionThread::measureRays() {
  const double now = clock_.seconds();
  if ((now - lastRates_ < kRateSeconds && !next_.progress.complete) || !(next_.progress.seconds > 0)) return;
  lastRates_ = now;
  const render::RayCount count = session_->rays();
  next_.raysPerSecond = static_cast<double>(count.rays) / next_.progress.seconds;
  next_.droppedSamples = count.droppedSamples;
  next_.droppedPixels.clear();
  if (count.droppedSamples > 0) next_.droppedPixels = session_->droppedPixels(kMaxMarkedPixels);
}

// What `render` reports at its end, unless the last complete image had it, too.
void SessionThread::warnAboutResult() {
  const std::vector<std::string> warnings = job::resultWarnings(session_->result());
  for (const std::string& warning : warnings)
    if (std::ranges::find(resultWarnings_, warning) == resultWarnings_.end())
      addMessage(Message::Kind::warning, warning);
  resultWarnings_ = warnings;
}

// A save waits until the film has its full size, unless the render has failed.
void SessionThread::writeSaves() {
  if (!session_->hasFullSize() && next_.renderError.empty()) return;
  for (const SaveRequest& save : std::exchange(saves_, {}))
    if (session_)
      guarded([&] {
        try {
          writeSave(save);
        } catch (const DeviceLostError&) {
          addMessage(Message::Kind::error,
                     fmt::format("{}: not saved, because the device was lost", save.file.string()));
          throw;
        }
      });
}

void SessionThread::writeSave(const SaveRequest& save) {
  if (!session_->hasFullSize())
    throw FileError(save.file, fmt::format("not saved, because the render failed: {}", next_.renderError));
  output::OutputRequest request;
  request.file = save.file;
  request.output = session_->state().output;
  if (output::fileKind(save.file) == output::FileKind::png) {
    request.exposure = session_->state().exposure;
    request.toneMap = session_->state().toneMap;
  }
  const output::OutputPlan plan = output::planOutputs(request, session_->program());
  output::writeOutputs(plan, session_->result(), *host_);
  if (options_.onEvent) options_.onEvent(interactive::savedJson(save.file.string()));
  addMessage(Message::Kind::note, fmt::format("saved {}", save.file.string()));
}

}  // namespace quintet::viewer
