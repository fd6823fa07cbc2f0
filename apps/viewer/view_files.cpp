// SPDX-License-Identifier: Apache-2.0
#include "view_files.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "io/codec.h"
#include "job/explanation_json.h"
#include "viewer/dropped_file.h"

namespace quintet::viewer {
namespace {

std::string absolutePath(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path result = std::filesystem::absolute(path, error);
  return error ? path.string() : result.lexically_normal().string();
}

// The current request with its camera and parameters removed, or the default.
job::interactive::SessionRequest currentRequest(const ViewState& state) {
  job::interactive::SessionRequest request;
  if (state.snapshot->request) request = *state.snapshot->request;
  request.render.camera = {};
  request.render.assignments.clear();
  request.render.parameterFile.clear();
  if (state.ready()) request.program = state.snapshot->state.program;
  request.render.size = state.fixedSize.value_or(state.viewSize);
  return request;
}

void startSession(ViewState& state, job::interactive::SessionRequest request) {
  state.selection = {};
  state.playing = false;
  state.explain.pixel.reset();
  state.click = ClickUse::select;
  state.session->open(std::move(request));
}

void openSession(ViewState& state, job::interactive::SessionRequest request, const std::string& recent) {
  addRecentFile(state.settings, recent);
  storeSettings(state);
  startSession(state, std::move(request));
}

// A render rather than an environment.
bool hasSizeOfImage(const ViewState& state, const std::string& path) {
  if (!state.ready()) return false;
  try {
    const io::ImageInfo info = io::probeImage(readFile(path), path);
    return uvec2(info.width, info.height) == state.snapshot->state.size;
  } catch (const Error&) {
    return false;  // reported when the file is used
  }
}

// As A of a comparison.
void useExplanation(ViewState& state, const std::string& path) {
  try {
    state.explain.kept = std::make_shared<const job::PixelExplanation>(job::readExplanation(path));
    state.settings.openPanels.insert("Explain");
    state.compareExplanation(true);
    state.addMessage({Message::Kind::note, fmt::format("{} is A of the comparison in Explain", path)});
  } catch (const Error& error) {
    state.addMessage({Message::Kind::error, error.what()});
  }
}

template <class Write>
void reportingErrors(ViewState& state, const Write& write) {
  if (state.settingsFolder.empty()) return;
  try {
    write();
  } catch (const Error& error) {
    state.addMessage({Message::Kind::warning, error.what()});
  }
}

// If the invalid file cannot be renamed, nothing is stored.
template <class Read>
void readOrSetAside(ViewState& state, const char* name, const Read& read) {
  if (state.settingsFolder.empty()) return;
  const std::filesystem::path file = state.settingsFolder / name;
  std::string text;
  try {
    return read(file);
  } catch (const Error& error) {
    text = error.what();
  }
  try {
    text += fmt::format("; the file was renamed to {}", setAside(file).filename().string());
  } catch (const Error& error) {
    text += fmt::format("; {}", error.what());
    state.settingsFolder.clear();
  }
  state.addMessage({Message::Kind::warning, text});
}

constexpr const char* kSettingsFile = "viewer.json";
constexpr const char* kBookmarksFile = "bookmarks.json";

void readBookmarks(ViewState& state) {
  readOrSetAside(state, kBookmarksFile, [&](const auto& file) { state.bookmarks = Bookmarks::read(file); });
}

template <class Change>
void changeBookmarks(ViewState& state, const Change& change) {
  readBookmarks(state);
  change();
  reportingErrors(state, [&] { state.bookmarks.write(state.settingsFolder / kBookmarksFile); });
}

}  // namespace

std::string sceneKey(const Snapshot& snapshot) {
  if (!snapshot.request) return {};
  const std::filesystem::path& file = snapshot.request->render.scene;
  return file.empty() ? "program " + snapshot.state.program : absolutePath(file);
}

void openFile(ViewState& state, const std::string& path) {
  switch (useOfFile(path)) {
    case FileUse::scene: {
      job::interactive::SessionRequest request = currentRequest(state);
      request.render.scene = path;
      request.render.load.variant.clear();
      request.render.load.scene.clear();
      request.render.animation.clear();
      return openSession(state, std::move(request), path);
    }
    case FileUse::program: {
      // If a scene file is open, a new program is a change of the session, which can be undone.
      if (state.ready() && !state.snapshot->request->render.scene.empty()) {
        addRecentFile(state.settings, path);
        storeSettings(state);
        return state.apply(job::interactive::SetProgram{absolutePath(path)});
      }
      job::interactive::SessionRequest request = currentRequest(state);
      request.program = path;
      return openSession(state, std::move(request), path);
    }
    case FileUse::environment:
      if (hasSizeOfImage(state, path)) {
        useReference(state, path);
        if (state.reference)
          state.addMessage({Message::Kind::note,
                            fmt::format("{} has the size of the image, so it is compared with the image; to use it as "
                                        "the environment, type its name in Environment",
                                        path)});
        return;
      }
      if (state.ready())
        state.apply(job::interactive::SetEnvironment{.source = absolutePath(path)});
      else
        state.addMessage({Message::Kind::warning, fmt::format("{}: open a scene first", path)});
      return;
    case FileUse::reference: return useReference(state, path);
    case FileUse::explanation: return useExplanation(state, path);
    case FileUse::unknown:
      state.addMessage(
          {Message::Kind::error,
           fmt::format("{}: neither a scene (.glb, .gltf, .scene.toml), a program (.rt.glsl, a folder with "
                       "program.toml), an image nor an explanation (.json)",
                       path)});
  }
}

void useReference(ViewState& state, const std::string& path) {
  try {
    MemoryBudget budget(path, state.snapshot->request ? state.snapshot->request->render.load.maxMemory : 0);
    state.reference = std::make_shared<const io::Image>(io::readImage(path, budget));
    state.referenceFile = std::filesystem::path(path).filename().string();
    state.settings.openPanels.insert("Compare");
    if (state.controls.compare == CompareMode::off) state.controls.compare = CompareMode::split;
  } catch (const Error& error) {
    state.addMessage({Message::Kind::error, error.what()});
  }
}

void openRecent(ViewState& state, const std::string& file) {
  std::error_code error;
  if (std::filesystem::exists(file, error))
    openFile(state, file);
  else if (std::filesystem::path(file).is_absolute())
    state.addMessage({Message::Kind::error, fmt::format("{}: file not found", file)});
  else
    openLesson(state, file);
}

void openLesson(ViewState& state, const std::string& program) {
  job::interactive::SessionRequest request;
  request.program = program;
  request.render.size = state.fixedSize.value_or(state.viewSize);
  openSession(state, std::move(request), program);
}

void reopenScene(ViewState& state, const std::function<void(job::RenderRequest&)>& change) {
  namespace interactive = job::interactive;
  if (!state.ready()) return;
  const interactive::SessionState shown = state.snapshot->state;
  const std::string firstOutput = state.snapshot->program->outputs.front().name;
  interactive::SessionRequest request = interactive::withState(*state.snapshot->request, shown);
  change(request.render);
  startSession(state, std::move(request));
  if (shown.output != firstOutput) state.apply(interactive::SelectOutput{shown.output});
  if (shown.exposure != 0.0) state.apply(interactive::SetExposure{shown.exposure});
  if (shown.toneMap) state.apply(interactive::SetToneMap{shown.toneMap});
}

void saveExplanation(ViewState& state, const std::filesystem::path& file) {
  if (!state.explanation) {
    state.addMessage(
        {Message::Kind::error, fmt::format("{}: not saved, because no pixel is explained", file.string())});
    return;
  }
  try {
    writeFile(file, job::explanationJson(*state.explanation, state.explain.command));
    state.addMessage({Message::Kind::note, fmt::format("saved {}", file.string())});
  } catch (const Error& error) {
    state.addMessage({Message::Kind::error, error.what()});
  }
}

void readStoredFiles(ViewState& state) {
  readOrSetAside(state, kSettingsFile, [&](const auto& file) { state.settings = readSettings(file); });
  readBookmarks(state);
}

void addBookmark(ViewState& state) {
  if (!state.ready()) return;
  changeBookmarks(state, [&] {
    const std::string name = state.bookmarks.add(sceneKey(*state.snapshot), state.snapshot->state.camera);
    state.addMessage({Message::Kind::note, fmt::format("added {}", name)});
  });
}

void removeBookmark(ViewState& state, const Bookmark& bookmark) {
  if (!state.ready()) return;
  changeBookmarks(state, [&] { state.bookmarks.remove(sceneKey(*state.snapshot), bookmark); });
}

void storeSettings(ViewState& state) {
  reportingErrors(state, [&] { writeSettings(state.settingsFolder / kSettingsFile, state.settings); });
}

}  // namespace quintet::viewer
