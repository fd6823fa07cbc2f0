// SPDX-License-Identifier: Apache-2.0
#include "application.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <thread>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "gpu/error.h"
#include "gui/style.h"
#include "gui/widgets.h"
#include "job/provenance.h"
#include "overlay/window_shaders.h"
#include "panels/panels.h"
#include "render/renderer/renderer.h"
#include "reproduce.h"
#include "view_files.h"
#include "viewer/edit_script.h"

namespace quintet::viewer {
namespace {

constexpr double kFrameSeconds = 1.0 / 60.0;
constexpr double kIdleSeconds = 0.5;
constexpr double kWaitingSeconds = 0.1;      // between frames that show how long the work takes
constexpr double kResizeSeconds = 0.15;      // the size of the image follows that of the window after this time
constexpr double kCheapSeconds = 3.0;        // of rendering, which a new size may discard without a question
constexpr double kClosingSeconds = 1.0;      // the process does not wait longer for a launch when the window is closed
constexpr double kBlockedHintSeconds = 2.0;  // after which the window shows that a launch takes long
constexpr int kStableFrames = 3;
constexpr int kMaxLosses = 3;                           // of the device that presents, in sequence
constexpr double kStableSeconds = 60;                   // after which a loss is not a repetition
constexpr std::chrono::milliseconds kReopenPause{250};  // a driver can need some time after a reset
constexpr float kMinImageSide = 4.0f;                   // pixels; smaller areas keep the last size
constexpr float kEdgeWidth = 8.0f;                      // of the panels, pixels at scale 1
constexpr double kExposureStep = 1.0 / 3.0;             // stops

ViewState initialState(const ApplicationOptions& options) {
  ViewState state;
  if (options.storesSettings) state.settingsFolder = settingsFolder();
  readStoredFiles(state);
  if (options.theme) state.settings.theme = *options.theme;
  if (options.windowSize) state.settings.windowSize = *options.windowSize;
  if (options.session && options.session->render.size.x > 0) state.fixedSize = options.session->render.size;
  return state;
}

// "Undo move of 'Lamp'". The part after "##" keeps the same menu item if the name changes.
std::string stepLabel(const char* verb, const std::string& name) {
  if (name.empty()) return verb;
  return fmt::format("{} {}##{}", verb, fittingText(name, 20.0f * ImGui::GetFontSize()), verb);
}

std::filesystem::path baseName(const Snapshot& snapshot) {
  const std::filesystem::path& scene = snapshot.request->render.scene;
  const std::filesystem::path name = scene.empty() ? std::filesystem::path(snapshot.state.program) : scene;
  return name.stem().empty() ? "image" : name.stem();
}

}  // namespace

Application::Presentation::Presentation(const Window& window, const ApplicationOptions& options)
    : context({.device = options.presentDevice, .log = options.engine.log, .surface = window.surfaceSource()}),
      swapchain(context),
      renderer([&] {
        const overlay::WindowShaders shaders = overlay::compileWindowShaders(options.engine.caches);
        return gpu::DrawListRenderer(context, swapchain.format(), shaders.vertex, shaders.fragment);
      }()) {}

Application::Application(ApplicationOptions options)
    : options_(std::move(options)), state_(initialState(options_)), window_("Quintet", state_.settings.windowSize) {
  displayScale_ = window_.contentScale() / window_.pixelScale();
  state_.scale = options_.scale > 0          ? options_.scale
                 : state_.settings.scale > 0 ? state_.settings.scale
                                             : displayScale_;
  gui_ = std::make_unique<Gui>(window_, state_.settings.theme, state_.scale);
  presentation_ = std::make_unique<Presentation>(window_, options_);
  displays_ = std::make_unique<DisplayThread>([] { Window::wake(); });
  session_ = std::make_unique<SessionThread>(
      SessionThread::Options{options_.engine, [] { Window::wake(); }, options_.onEvent});
  state_.session = session_.get();
  state_.snapshot = session_->snapshot();
  if (options_.restarted && options_.restarted->position) window_.setPosition(*options_.restarted->position);
  pendingSession_ = options_.session;
  if (options_.logsWidgets)
    setWidgetLog([this](const std::string& name, vec2 least, vec2 most) { logWidget(name, least, most); });
}

Application::~Application() {
  setWidgetLog({});
  keepSettings();
}

void Application::run() {
  while (!quit_ && !window_.shouldClose()) frame(waitTime());
  // A thread cannot be ended, and a launch that hangs would keep the process for minutes.
  if (session_->blockedSeconds() < kClosingSeconds) return;
  keepSettings();
  std::_Exit(0);
}

void Application::keepSettings() {
  if (!options_.storesSettings) return;
  const uvec2 size = window_.windowedSize();
  if (size.x > 1 && size.y > 1) state_.settings.windowSize = size;
  storeSettings(state_);
}

double Application::waitTime() const {
  if (framesToDraw_ > 0) return 0;
  if (state_.playing || navigator_.flying() || state_.snapshot->phase == Snapshot::Phase::loading) return kFrameSeconds;
  if (state_.ready() && !state_.fixedSize && !state_.keptSize && wantedSize_ != imageSize_) return kResizeSeconds / 3;
  if (state_.waitingSince) return kWaitingSeconds;
  return kIdleSeconds;
}

void Application::frame(double wait) {
  events_ = window_.waitForEvents(wait, dialog_.awaitsFocus());
  const double now = clock_.seconds();
  const double elapsed = now - std::exchange(lastFrame_, now);
  state_.time = now;
  framesToDraw_ = events_.empty() ? std::max(framesToDraw_ - 1, 0) : kStableFrames;
  receive();
  for (const InputEvent& event : events_)
    if (const auto* drop = std::get_if<DropEvent>(&event))
      for (const std::string& path : drop->paths) openFile(state_, path);
  const uvec2 size = window_.size();
  if (size.x == 0 || size.y == 0 || window_.minimized()) {
    framesToDraw_ = 0;
    return;
  }
  if (state_.ready()) updateRays(state_);
  gui_->setTheme(state_.settings.theme);
  gui_->setScale(state_.scale);
  gui_->beginFrame();
  const Area area = layOut();
  std::erase_if(events_, [&](const InputEvent& event) { return closeTopmost(event); });
  performAll(navigator_.handle(state_, events_, area));
  navigator_.fly(state_, std::min(elapsed, 0.1));
  if (state_.playing) play();
  buildInterface();
  const gpu::DrawList list = gui_->endFrame();
  if (takeEditEnd()) state_.apply(job::interactive::EndDrag{});
  performAll(std::exchange(state_.requests, {}));
  chooseImageSize(area);
  requestDisplay();
  draw(list);
  handleBlockedWork();
}

// Escape in menus, lists and fields. In all else, it is an action.
bool Application::closeTopmost(const InputEvent& event) {
  const auto* key = std::get_if<KeyEvent>(&event);
  if (!key || !key->pressed || key->key != "Escape") return false;
  if (Gui::closePopups()) return true;
  if (dialog_.visible() && Gui::wantsKeyboard()) {
    dialog_.close();
    return true;
  }
  return false;
}

// ---- Between the threads

void Application::receive() {
  const std::shared_ptr<const Snapshot> last = std::exchange(state_.snapshot, session_->snapshot());
  if (last != state_.snapshot) framesToDraw_ = std::max(framesToDraw_, 1);
  for (Message& message : session_->takeMessages()) {
    state_.addMessage(std::move(message));
    framesToDraw_ = kStableFrames;
  }
  if (last->explanation != state_.snapshot->explanation) setExplanation();
  for (const std::optional<job::interactive::Pick>& pick : session_->takePicks())
    state_.selection = pick ? Selection{Selection::Kind::instance, pick->instance} : Selection{};
  if (last->session != state_.snapshot->session || last->phase != state_.snapshot->phase) {
    forgetPendingValues();
    requestedExposures_.clear();
    if (state_.ready()) {
      imageSize_ = state_.snapshot->state.size;
      window_.setTitle(fmt::format("{} - Quintet", baseName(*state_.snapshot).string()));
    }
  }
  if (state_.ready() && last->state.exposure != state_.snapshot->state.exposure)
    confirmExposure(state_.snapshot->state.exposure);
  if (last->diagnostics.size() != state_.snapshot->diagnostics.size()) state_.showDiagnostics = true;
  if (state_.snapshot->phase != Snapshot::Phase::loading)
    state_.loadingSince.reset();
  else if (!state_.loadingSince || last->session != state_.snapshot->session)
    state_.loadingSince = state_.time;
  const bool waits = state_.ready() && (!state_.snapshot->image || !state_.snapshot->stage.empty() ||
                                        session_->blockedSeconds() > kBlockedHintSeconds);
  if (!waits)
    state_.waitingSince.reset();
  else if (!state_.waitingSince)
    state_.waitingSince = state_.time;
  if (last->imageNumber != state_.snapshot->imageNumber) imageTime_ = state_.time;
  if (state_.ready() && last->imageNumber != state_.snapshot->imageNumber) {
    if (state_.snapshot->secondsPerImage > 0)
      state_.imageRates.add(static_cast<float>(1.0 / state_.snapshot->secondsPerImage));
    state_.rayRates.add(static_cast<float>(1e-6 * state_.snapshot->raysPerSecond));
  }
  state_.display = displays_->latest();
  if (std::string error = displays_->error(); error != displayError_) {
    if (!error.empty())
      state_.addMessage({Message::Kind::error, fmt::format("the image cannot be displayed: {}", error)});
    displayError_ = std::move(error);
    framesToDraw_ = kStableFrames;
  }
}

// The command is made now, because the scene can change later.
void Application::setExplanation() {
  const Snapshot& snapshot = *state_.snapshot;
  const job::PixelExplanation* explanation = snapshot.explanation.get();
  const bool known = explanation && state_.ready() && !snapshot.explanationOutdated;
  state_.setExplanation(snapshot.explanation,
                        known ? explainingCommand(snapshot, explanation->pixel, explanation->sample) : "");
}

// The image has the pixels of its area, unless its size is fixed. A change of the size discards the samples. Therefore, if
// they took long, the image is scaled until the user asks for the new size (Action::fitImage).
void Application::chooseImageSize(const Area& area) {
  if (state_.fixedSize) {
    wantedSize_ = imageSize_ = *state_.fixedSize;
  } else if (area.size.x >= kMinImageSide && area.size.y >= kMinImageSide) {
    const float pixels = state_.settings.resolution * window_.pixelScale();
    const uvec2 size = glm::max(uvec2(glm::round(area.size * pixels)), uvec2(1));
    if (size != wantedSize_) wantedSince_ = state_.time;
    wantedSize_ = size;
  }
  state_.viewSize = wantedSize_;
  if (pendingSession_ && wantedSize_.x > 0) return openFirst();
  const bool asked = std::exchange(state_.fitsImage, false);
  state_.keptSize = false;
  if (!state_.ready() || state_.fixedSize) return;
  if (wantedSize_ == state_.snapshot->state.size) {
    imageSize_ = wantedSize_;
  } else if (wantedSize_ != imageSize_ && (asked || state_.time - wantedSince_ >= kResizeSeconds)) {
    if (asked || lostSeconds() < kCheapSeconds) {
      imageSize_ = wantedSize_;
      state_.apply(job::interactive::SetSize{wantedSize_, /*ofWindow=*/true});
    } else {
      state_.keptSize = true;
    }
  }
}

// The size of the image is known now.
void Application::openFirst() {
  job::interactive::SessionRequest request = *std::exchange(pendingSession_, std::nullopt);
  imageSize_ = wantedSize_;
  request.render.size = wantedSize_;
  const std::optional<RestartNote>& note = options_.restarted;
  if (note && !note->error.empty())
    return session_->openAfterSave(std::move(request), note->script, note->error, note->diagnostics);
  if (!request.render.scene.empty()) addRecentFile(state_.settings, request.render.scene.string());
  session_->open(std::move(request), note ? note->script : std::vector<std::string>());
}

// Of rendering, if the samples are discarded now.
double Application::lostSeconds() const {
  const job::interactive::ImageUpdated& image = state_.snapshot->progress;
  if (!state_.snapshot->image || image.factor > 1) return 0;
  return image.seconds + (image.complete ? 0.0 : state_.time - imageTime_);
}

// ---- Work that does not end

// Only the end of the process ends the threads of a driver that work on an endless launch.
void Application::handleBlockedWork() {
  const Snapshot& snapshot = *state_.snapshot;
  if (snapshot.phase == Snapshot::Phase::failed && snapshot.hung)
    restart(snapshot.error, snapshot.diagnostics);
  else if (std::exchange(state_.stopsWork, false))
    restart("The work was stopped", {});
  else if (session_->savedWhileBlocked())
    restart({}, {});
}

// `error`: the new process waits for a save; empty if it renders at once. Has no effect if the process cannot be replaced.
void Application::restart(const std::string& error, const std::vector<Diagnostic>& diagnostics) {
  if (!state_.snapshot->request || std::exchange(cannotRestart_, true)) return;
  RestartNote note;
  note.error = error;
  note.diagnostics = diagnostics;
  note.position = window_.position();
  std::vector<std::string> arguments = viewArguments(*state_.snapshot, state_.fixedSize.has_value());
  if (state_.snapshot->program) {
    note.script = editScript(*state_.snapshot);
    const std::vector<std::string> display = displayScript(*state_.snapshot);
    note.script.insert(note.script.end(), display.begin(), display.end());
  }
  arguments.insert(arguments.end(), options_.windowArguments.begin(), options_.windowArguments.end());
  const uvec2 size = window_.windowedSize();
  arguments.insert(arguments.end(), {"--window-size", fmt::format("{}x{}", size.x, size.y)});
  keepSettings();
  state_.addMessage({Message::Kind::error, restartProcess(arguments, note)});
}

void Application::requestDisplay() {
  const Snapshot& snapshot = *state_.snapshot;
  if (!state_.ready() || !snapshot.image) return;
  DisplaySettings settings;
  settings.exposure = snapshot.state.exposure;
  settings.toneMap = snapshot.state.toneMap.value_or(render::defaultToneMap(snapshot.outputKind));
  settings.heat = snapshot.outputKind == program::OutputKind::heat && !snapshot.state.toneMap;
  settings.falseColor = state_.controls.falseColor;
  settings.channel = state_.controls.channel;
  settings.range = state_.controls.range;
  settings.compare = state_.controls.compare;
  settings.marksNotFinite = state_.controls.marksNotFinite;
  if (snapshot.imageNumber == displayedImage_ && snapshot.session == displayedSession_ &&
      settings == displayedSettings_ && state_.reference == displayedReference_)
    return;
  displayedImage_ = snapshot.imageNumber;
  displayedSession_ = snapshot.session;
  displayedSettings_ = settings;
  displayedReference_ = state_.reference;
  displays_->request({snapshot.image, state_.reference, settings});
}

void Application::updateTextures() {
  const FontPixels font = gui_->takeFont();
  gpu::DrawListRenderer& renderer = presentation_->renderer;
  if (font.rgba) renderer.setTexture(kFontTexture, {font.size.x, font.size.y}, font.rgba);
  if (!state_.display || (state_.display == textured_ && state_.placement.scale == textureScale_)) return;
  textured_ = state_.display;
  textureScale_ = state_.placement.scale;
  const auto set = [&](std::size_t texture, const DisplayPixels& pixels) {
    if (!pixels.bytes || pixels.bytes->empty()) return;
    // Pixels stay visible if they are large; reduced images are smooth.
    const bool full = pixels.size == state_.placement.size;
    const VkFilter filter = full && textureScale_ >= 2.0f ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    renderer.setTexture(texture, {pixels.size.x, pixels.size.y}, pixels.bytes, filter);
  };
  set(kImageTexture, textured_->image);
  set(kReferenceTexture, textured_->reference);
}

void Application::draw(const gpu::DrawList& list) {
  const uvec2 size = window_.size();
  try {
    updateTextures();
    presentation_->swapchain.draw({size.x, size.y}, [&](gpu::Commands& commands, const gpu::RenderTarget& target) {
      prepareLines(commands, target);
      const auto drawLines = [&](gpu::Commands& to, const gpu::RenderTarget& on, const VkRect2D& rectangle) {
        if (presentation_->lines) presentation_->lines->record(to, on, rectangle);
      };
      presentation_->renderer.draw(commands, target, list, gui_->background(), drawLines);
    });
  } catch (const DeviceLostError& error) {
    replacePresentation(error);
  } catch (const gpu::VulkanError& error) {
    if (error.result() != VK_ERROR_SURFACE_LOST_KHR) throw;
    replacePresentation(error);
  }
}

// The rays of the explained pixel. Without them it has no effect.
void Application::prepareLines(gpu::Commands& commands, const gpu::RenderTarget& target) {
  if (!state_.rays.visible() && !presentation_->lines) return;
  std::unique_ptr<gpu::LineRenderer>& lines = presentation_->lines;
  if (!lines) {
    const overlay::WindowShaders shaders = overlay::compileLineShaders(options_.engine.caches);
    lines = std::make_unique<gpu::LineRenderer>(presentation_->context, presentation_->swapchain.format(),
                                                shaders.vertex, shaders.fragment);
  }
  if (presentation_->depthOfLines != state_.rays.depth) {
    presentation_->depthOfLines = state_.rays.depth;
    if (const job::DepthMap* depth = state_.rays.depth.get())
      lines->setDepth({depth->size.x, depth->size.y}, overlay::reversedDepths(*depth));
    else
      lines->setDepth({}, nullptr);
  }
  lines->prepare(commands, target.slot, state_.rays.lines);
}

// After the device or the surface was lost. Throws Error after kMaxLosses attempts.
void Application::replacePresentation(const Error& cause) {
  if (clock_.seconds() - presentationLost_ > kStableSeconds) presentationLosses_ = 0;
  presentation_.reset();
  std::string failure = cause.what();
  while (!presentation_) {
    if (++presentationLosses_ > kMaxLosses)
      throw Error(fmt::format("the window cannot be drawn: its device was lost {} times in sequence: {}",
                              kMaxLosses + 1, failure));
    std::this_thread::sleep_for((presentationLosses_ - 1) * kReopenPause);
    try {
      presentation_ = std::make_unique<Presentation>(window_, options_);
    } catch (const Error& error) {
      failure = error.what();
    }
  }
  presentationLost_ = clock_.seconds();
  state_.addMessage({Message::Kind::warning, "the device that draws the window was lost and opened again"});
  gui_->sendFontAgain();
  textured_ = nullptr;
  framesToDraw_ = kStableFrames;
}

// ---- Interface

Area Application::layOut() {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float top = ImGui::GetFrameHeight();
  float bottom = statusBarHeight();
  if (state_.ready() && state_.snapshot->animated) bottom += animationBarHeight();
  float right = 0.0f;
  if (state_.settings.panels && state_.ready()) {
    right = std::min(state_.settings.panelWidth * state_.scale, 0.6f * display.x);
    if (display.x < 200.0f * state_.scale) right = 0.0f;  // too narrow for both
  }
  const Area area{{0.0f, top}, glm::max(vec2(display.x - right, display.y - top - bottom), vec2(1.0f))};
  if (state_.ready())
    state_.placement = overlay::fitImage(state_.snapshot->state.size, area.origin, area.size,
                                         state_.fixedSize ? 1.0f / window_.pixelScale() : 1000.0f);
  return area;
}

void Application::buildInterface() {
  nextWidgets_.clear();
  const Area area = layOut();
  menuBar();
  switch (state_.snapshot->phase) {
    case Snapshot::Phase::empty: startScreen(state_, area, lessonList()); break;
    case Snapshot::Phase::loading: loadingScreen(state_, area); break;
    case Snapshot::Phase::failed: failureScreen(state_, area); break;
    case Snapshot::Phase::ready: imageArea(area); break;
  }
  diagnosticsDrawer(state_, area);
  toasts(state_, area);
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float height = statusBarHeight();
  statusBar(state_, {{0.0f, display.y - height}, {display.x, height}});
  helpWindow(state_);
  finishDialog();
  if (options_.logsWidgets) emitWidgets();
}

void Application::imageArea(const Area& area) {
  drawImage();
  rayLines(state_, area);
  selectionOutline(state_, area);
  explainedPixel(state_, area);
  notFinitePixels(state_, area);
  splitLine(state_, area);
  legend(state_, area);
  rayLegendBox(state_, area);
  sizeNote(state_, area);
  waitingNote(state_, area);
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  if (state_.snapshot->animated)
    animationBar(state_, {{0.0f, area.origin.y + area.size.y}, {area.size.x, animationBarHeight()}});
  const float left = area.origin.x + area.size.x;
  if (left < display.x) {
    const Area panels{{left, area.origin.y}, {display.x - left, display.y - area.origin.y - statusBarHeight()}};
    sidePanel(panels);
    panelEdge(panels);
  }
}

void Application::drawImage() {
  if (!state_.display || !state_.display->image.bytes) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const overlay::ImagePlacement& at = state_.placement;
  const vec2 end = at.origin + at.scale * vec2(at.size);
  const bool splits = state_.display->reference.bytes && state_.controls.compare == CompareMode::split;
  const float split = splits ? state_.controls.split : 1.0f;
  const float x = splits ? std::round(glm::mix(at.origin.x, end.x, split)) : end.x;
  list.AddImage(textureId(kImageTexture), {at.origin.x, at.origin.y}, {x, end.y}, {0.0f, 0.0f}, {split, 1.0f});
  if (splits)
    list.AddImage(textureId(kReferenceTexture), {x, at.origin.y}, {end.x, end.y}, {split, 0.0f}, {1.0f, 1.0f});
}

// The left edge of the panels, which changes their width. A window of its own, because the contents of a window end before
// its border.
void Application::panelEdge(const Area& area) {
  const float width = kEdgeWidth * state_.scale;
  const vec2 origin{area.origin.x - 0.5f * width, area.origin.y};
  ImGui::SetNextWindowPos({origin.x, origin.y});
  ImGui::SetNextWindowSize({width, std::max(area.size.y, 1.0f)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0.0f, 0.0f});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1.0f, 1.0f});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0f);
  ImGui::Begin("edge of the panels", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::InvisibleButton("edge", {width, std::max(area.size.y, 1.0f)});
  logControl("Edge of the panels");
  const bool active = ImGui::IsItemActive();
  if (ImGui::IsItemHovered() || active) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    const ImU32 color = ImGui::GetColorU32(active ? ImGuiCol_SeparatorActive : ImGuiCol_SeparatorHovered);
    ImGui::GetWindowDrawList()->AddRectFilled({origin.x, origin.y}, {origin.x + width, origin.y + area.size.y}, color);
  }
  if (active) {
    const float wanted = ImGui::GetIO().DisplaySize.x - ImGui::GetIO().MousePos.x;
    state_.settings.panelWidth = std::clamp(wanted / state_.scale, kMinPanelWidth, kMaxPanelWidth);
  }
  if (ImGui::IsItemDeactivated()) storeSettings(state_);
  ImGui::End();
  ImGui::PopStyleVar(3);
}

void Application::sidePanel(const Area& area) {
  ImGui::SetNextWindowPos({area.origin.x, area.origin.y});
  ImGui::SetNextWindowSize({area.size.x, std::max(area.size.y, 1.0f)});
  ImGui::Begin("panels", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
  struct Panel {
    const char* name;
    void (*draw)(ViewState&);
  };
  constexpr std::array kPanels{
      Panel{"Scene", scenePanel},          Panel{"Selection", selectionPanel},     Panel{"Explain", explainPanel},
      Panel{"Printed", printedPanel},      Panel{"Environment", environmentPanel}, Panel{"Parameters", parametersPanel},
      Panel{"Display", displayPanel},      Panel{"Camera", cameraPanel},           Panel{"Compare", comparePanel},
      Panel{"Statistics", statisticsPanel}};
  for (const Panel& panel : kPanels) {
    bool open = state_.settings.openPanels.count(panel.name) > 0;
    ImGui::PushID(panel.name);
    if (section(panel.name, open)) {
      panel.draw(state_);
      ImGui::Spacing();
    }
    ImGui::PopID();
    if (open)
      state_.settings.openPanels.insert(panel.name);
    else
      state_.settings.openPanels.erase(panel.name);
  }
  endSections();
  ImGui::End();
}

void Application::menuBar() {
  const BindingSet& set = bindingSet(state_.settings.bindings);
  const auto item = [&](const std::string& label, Action action, bool enabled = true) {
    if (ImGui::MenuItem(label.c_str(), keysOf(set, action).c_str(), false, enabled)) perform(action);
    logControl(label.c_str());
  };
  const auto menu = [](const char* label) {
    const bool open = ImGui::BeginMenu(label);
    logControl(label);
    return open;
  };
  if (!ImGui::BeginMainMenuBar()) return;
  const bool ready = state_.ready();
  if (menu("File")) {
    item("Open...", Action::open);
    if (ImGui::BeginMenu("Open recent", !state_.settings.recentFiles.empty())) {
      for (const std::string& file : std::vector<std::string>(state_.settings.recentFiles))
        if (ImGui::MenuItem(file.c_str())) openRecent(state_, file);
      ImGui::EndMenu();
    }
    item("Save image...", Action::save, ready);
    item("Copy command", Action::copyCommand, ready);
    item("Save explanation...", Action::saveExplanation, ready && state_.explanation);
    ImGui::Separator();
    item("Quit", Action::quit);
    ImGui::EndMenu();
  }
  if (menu("Edit")) {
    item(stepLabel("Undo", state_.snapshot->undoName), Action::undo, ready && state_.snapshot->canUndo);
    item(stepLabel("Redo", state_.snapshot->redoName), Action::redo, ready && state_.snapshot->canRedo);
    ImGui::EndMenu();
  }
  if (menu("Camera")) {
    item("Show the scene", Action::frameAll, ready);
    item("Show the selection", Action::frameSelected, ready);
    item("Initial view", Action::resetCamera, ready);
    item("Add bookmark", Action::addBookmark, ready);
    ImGui::EndMenu();
  }
  if (menu("View")) {
    if (ImGui::MenuItem("Panels", keysOf(set, Action::togglePanels).c_str(), state_.settings.panels))
      perform(Action::togglePanels);
    if (ImGui::MenuItem("Rays of the pixel", keysOf(set, Action::toggleRays).c_str(), state_.rays.enabled,
                        state_.rays.paths.has_value()))
      perform(Action::toggleRays);
    logControl("Rays of the pixel");
    ImGui::MenuItem("Diagnostics", nullptr, &state_.showDiagnostics, !state_.snapshot->diagnostics.empty());
    item("Fit the image to the window", Action::fitImage, ready && !state_.fixedSize);
    item("Full screen", Action::toggleFullScreen);
    item("Switch theme", Action::toggleTheme);
    if (ImGui::BeginMenu("Text size")) {
      for (const float scale : {0.75f, 1.0f, 1.25f, 1.5f, 2.0f, 2.5f, 3.0f})
        if (ImGui::MenuItem(fmt::format("{:.0f} %", 100.0f * scale).c_str(), nullptr, state_.scale == scale))
          state_.settings.scale = state_.scale = scale;
      if (ImGui::MenuItem("Same as the display", nullptr, state_.settings.scale == 0.0f)) {
        state_.settings.scale = 0.0f;
        state_.scale = displayScale_;
      }
      ImGui::EndMenu();
    }
    ImGui::EndMenu();
  }
  if (menu("Help")) {
    item("Mouse and keyboard", Action::help);
    ImGui::EndMenu();
  }
  ImGui::EndMainMenuBar();
}

const std::vector<Lesson>& Application::lessonList() {
  if (lessons_.empty()) lessons_ = lessons();
  return lessons_;
}

void Application::finishDialog() {
  const FileDialog::Purpose purpose = dialog_.purpose();
  const std::optional<std::filesystem::path> chosen = dialog_.draw(state_.scale);
  if (!chosen) return;
  if (purpose == FileDialog::Purpose::open)
    openFile(state_, chosen->string());
  else if (purpose == FileDialog::Purpose::reference)
    useReference(state_, chosen->string());
  else if (purpose == FileDialog::Purpose::saveExplanation)
    saveExplanation(state_, *chosen);
  else
    session_->save(*chosen);
}

// ---- Actions

void Application::performAll(const std::vector<Action>& actions) {
  for (const Action action : actions) perform(action);
}

void Application::perform(Action action) {
  namespace interactive = job::interactive;
  framesToDraw_ = kStableFrames;
  const bool ready = state_.ready();
  switch (action) {
    case Action::open: return dialog_.open();
    case Action::help: state_.showHelp = !state_.showHelp; return;
    case Action::quit: quit_ = true; return;
    case Action::togglePanels: state_.settings.panels = !state_.settings.panels; return;
    case Action::fitImage: state_.fitsImage = true; return;
    case Action::toggleFullScreen: return window_.toggleFullScreen();
    case Action::toggleRays:
      if (state_.rays.paths) state_.rays.enabled = !state_.rays.enabled;
      return;
    case Action::toggleTheme:
      state_.settings.theme = state_.settings.theme == Theme::dark ? Theme::light : Theme::dark;
      return;
    case Action::close:
      if (dialog_.visible())
        dialog_.close();
      else if (state_.showHelp)
        state_.showHelp = false;
      else if (state_.click != ClickUse::select)
        state_.click = ClickUse::select;
      else if (state_.explanation)
        state_.setExplanation(nullptr);
      else
        state_.selection = {};
      return;
    default: break;
  }
  if (!ready) return;
  const Snapshot& snapshot = *state_.snapshot;
  switch (action) {
    case Action::frameSelected: {
      const bool selected = state_.selection.kind == Selection::Kind::instance &&
                            state_.selection.index < snapshot.scene->instances.size();
      state_.apply(interactive::Frame{selected ? snapshot.scene->instances[state_.selection.index].name : ""});
      break;
    }
    case Action::frameAll: state_.apply(interactive::Frame{}); break;
    case Action::resetCamera: state_.apply(interactive::SetCamera{snapshot.request->render.camera}); break;
    case Action::undo:
    case Action::redo:
      forgetPendingValues();
      requestedExposures_.clear();
      if (action == Action::undo && snapshot.canUndo) {
        state_.apply(interactive::Undo{});
        state_.addMessage({Message::Kind::note, fmt::format("undone: {}", snapshot.undoName)});
      }
      if (action == Action::redo && snapshot.canRedo) {
        state_.apply(interactive::Redo{});
        state_.addMessage({Message::Kind::note, fmt::format("redone: {}", snapshot.redoName)});
      }
      break;
    case Action::save: dialog_.save(baseName(snapshot).string() + ".png"); break;
    case Action::copyCommand:
      window_.setClipboard(reproducingCommand(snapshot));
      state_.addMessage({Message::Kind::note, "copied the command that renders this image"});
      break;
    case Action::explain:
      if (state_.hoveredPixel) state_.explainPixel(*state_.hoveredPixel, state_.explain.sample);
      break;
    case Action::print:
      if (state_.hoveredPixel) state_.printPixels({state_.hoveredPixel->x, state_.hoveredPixel->y, 1, 1});
      break;
    case Action::openReference: dialog_.openReference(); break;
    case Action::saveExplanation:
      if (state_.explanation)
        dialog_.saveExplanation(
            fmt::format("pixel-{}-{}.json", state_.explanation->pixel.x, state_.explanation->pixel.y));
      break;
    case Action::copyExplainCommand:
      if (!state_.explanation) break;
      if (state_.explain.command.empty()) {
        state_.addMessage({Message::Kind::warning, "the scene has changed; explain the pixel again"});
        break;
      }
      window_.setClipboard(state_.explain.command);
      state_.addMessage({Message::Kind::note, "copied the command that explains this pixel"});
      break;
    case Action::addBookmark: addBookmark(state_); break;
    case Action::playPause:
      if (!snapshot.animated) break;
      state_.playing = !state_.playing;
      state_.playStart = state_.time - snapshot.state.frame / snapshot.request->render.framesPerSecond;
      break;
    case Action::previousOutput: changeOutput(-1); break;
    case Action::nextOutput: changeOutput(1); break;
    case Action::lessExposure: changeExposure(-kExposureStep); break;
    case Action::moreExposure: changeExposure(kExposureStep); break;
    case Action::compare:
      if (state_.reference)
        state_.controls.compare = state_.controls.compare == CompareMode::off ? CompareMode::split : CompareMode::off;
      break;
    default: break;
  }
}

void Application::changeOutput(int direction) {
  std::vector<std::string> names;
  std::ptrdiff_t index = 0;
  for (const program::Output& output : state_.snapshot->program->outputs) {
    if (output.pixel == program::OutputPixel::coverage) continue;
    if (output.name == state_.snapshot->state.output) index = std::ssize(names);
    names.push_back(output.name);
  }
  const std::ptrdiff_t count = std::ssize(names);
  if (count < 2) return;
  state_.apply(job::interactive::SelectOutput{names[static_cast<std::size_t>((index + direction + count) % count)]});
}

// Adds to the last value, which the session has not shown yet if a batch takes long.
void Application::changeExposure(double stops) {
  const double last = requestedExposures_.empty() ? state_.snapshot->state.exposure : requestedExposures_.back();
  requestedExposures_.push_back(std::clamp(last + stops, -job::kMaxExposure, job::kMaxExposure));
  state_.apply(job::interactive::SetExposure{requestedExposures_.back()});
}

void Application::confirmExposure(double exposure) {
  const auto found = std::ranges::find(requestedExposures_, exposure);
  requestedExposures_.erase(requestedExposures_.begin(), found == requestedExposures_.end() ? found : std::next(found));
}

void Application::play() {
  if (!state_.ready() || !state_.snapshot->animated) return;
  const double last = std::max(1.0f, state_.snapshot->scene->lastFrame);
  const double frame =
      std::fmod((state_.time - state_.playStart) * state_.snapshot->request->render.framesPerSecond, last + 1.0);
  state_.apply(job::interactive::SetFrame{static_cast<float>(std::min(frame, last))});
}

// ---- For tests

void Application::logWidget(const std::string& name, vec2 least, vec2 most) {
  nextWidgets_ += nlohmann::json{{"name", name}, {"rect", {least.x, least.y, most.x, most.y}}}.dump();
  nextWidgets_ += ',';
}

void Application::emitWidgets() {
  if (nextWidgets_ == widgets_) return;
  widgets_ = nextWidgets_;
  const std::string list = widgets_.empty() ? "" : widgets_.substr(0, widgets_.size() - 1);
  const Area area = layOut();
  if (options_.onEvent)
    options_.onEvent(fmt::format(R"({{"event":"controls","image":[{},{},{},{}],"controls":[{}]}})", area.origin.x,
                                 area.origin.y, area.origin.x + area.size.x, area.origin.y + area.size.y, list));
}

}  // namespace quintet::viewer
