// SPDX-License-Identifier: Apache-2.0
// The window with its panels, and the loop that handles input and draws.
#ifndef QUINTET_APPS_VIEWER_APPLICATION_H
#define QUINTET_APPS_VIEWER_APPLICATION_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/stopwatch.h"
#include "gpu/context.h"
#include "gpu/present/draw_list_renderer.h"
#include "gpu/present/line_renderer.h"
#include "gpu/present/swapchain.h"
#include "gui/gui.h"
#include "job/engine.h"
#include "job/interactive/session.h"
#include "navigator.h"
#include "overlays/file_dialog.h"
#include "overlays/overlays.h"
#include "restart.h"
#include "view_state.h"
#include "viewer/display_thread.h"
#include "window/window.h"

namespace quintet::viewer {

struct ApplicationOptions {
  std::optional<job::interactive::SessionRequest> session;  // unset: the start screen
  job::EngineOptions engine;
  std::string presentDevice;                             // gpu::ContextOptions::device of the window
  float scale = 0;                                       // size of text and controls; 0 means that of the settings
  std::optional<Theme> theme;                            // unset: that of the settings
  std::optional<uvec2> windowSize;                       // Settings::windowSize; unset: that of the settings
  bool storesSettings = true;                            // in the user's folder
  std::function<void(const std::string& json)> onEvent;  // lines of JSON; may be empty
  bool logsWidgets = false;                              // onEvent also gets the rectangles of all controls
  std::optional<RestartNote> restarted;                  // what the process before this one has left
  std::vector<std::string> windowArguments;              // options that a new process gets again
};

class Application {
 public:
  // Opens the window. Throws Error, gpu::NoDeviceError.
  explicit Application(ApplicationOptions options);
  ~Application();

  // Until the window is closed. Throws Error if the window can no longer be drawn.
  void run();

 private:
  // The device that presents. Replaced if it is lost.
  struct Presentation {
    Presentation(const Window& window, const ApplicationOptions& options);
    gpu::Context context;
    gpu::Swapchain swapchain;
    gpu::DrawListRenderer renderer;
    std::unique_ptr<gpu::LineRenderer> lines;           // null until rays are drawn
    std::shared_ptr<const job::DepthMap> depthOfLines;  // in `lines`
  };

  void frame(double wait);
  double waitTime() const;
  void receive();         // what the threads have made since the last frame
  void setExplanation();  // that of the snapshot
  void chooseImageSize(const Area& area);
  void openFirst();
  double lostSeconds() const;
  void keepSettings();
  void handleBlockedWork();
  void restart(const std::string& error, const std::vector<Diagnostic>& diagnostics);
  bool closeTopmost(const InputEvent& event);
  void requestDisplay();
  void updateTextures();
  void buildInterface();
  Area layOut();  // of the image
  void menuBar();
  void panelEdge(const Area& area);
  void sidePanel(const Area& area);
  void imageArea(const Area& area);
  void drawImage();
  void perform(Action action);
  void performAll(const std::vector<Action>& actions);
  void changeOutput(int direction);
  void changeExposure(double stops);
  void confirmExposure(double exposure);  // the session shows this value now
  void play();
  void finishDialog();
  void draw(const gpu::DrawList& list);
  void prepareLines(gpu::Commands& commands, const gpu::RenderTarget& target);
  void replacePresentation(const Error& cause);
  const std::vector<Lesson>& lessonList();
  void emitWidgets();
  void logWidget(const std::string& name, vec2 least, vec2 most);

  const ApplicationOptions options_;
  Stopwatch clock_;
  ViewState state_;
  Window window_;
  std::unique_ptr<Gui> gui_;
  std::unique_ptr<Presentation> presentation_;
  std::unique_ptr<DisplayThread> displays_;
  std::unique_ptr<SessionThread> session_;
  Navigator navigator_;
  FileDialog dialog_;
  std::vector<Lesson> lessons_;
  std::vector<InputEvent> events_;

  float displayScale_ = 1;       // that the display asks for, in screen coordinates
  int framesToDraw_ = 3;         // after input, until the interface is stable
  double lastFrame_ = 0;         // on clock_
  int presentationLosses_ = 0;   // in sequence
  double presentationLost_ = 0;  // on clock_, the last time
  std::uint64_t displayedImage_ = 0, displayedSession_ = 0;
  DisplaySettings displayedSettings_;
  std::shared_ptr<const io::Image> displayedReference_;
  std::shared_ptr<const Display> textured_;  // in the textures
  float textureScale_ = 0;                   // of the placement when they were made
  uvec2 imageSize_{0};                       // size of the session's image, or the size requested last
  uvec2 wantedSize_{0};                      // size that fits the window
  double wantedSince_ = 0;                   // on clock_
  double imageTime_ = 0;                     // on clock_, of the last image of the session
  bool cannotRestart_ = false;               // restart() has failed
  std::vector<double> requestedExposures_;   // by changeExposure(), which the session has not confirmed
  std::string displayError_;                 // of displays_, as the last message shows it
  bool quit_ = false;
  std::string widgets_, nextWidgets_;  // last output of emitWidgets(), and the one of this frame
  std::optional<job::interactive::SessionRequest> pendingSession_;  // opened when the size of the image is known
};

}  // namespace quintet::viewer
#endif
