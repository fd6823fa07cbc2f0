// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <imgui.h>

#include "base/diagnostic.h"
#include "base/error.h"
#include "gui/style.h"
#include "gui/widgets.h"
#include "overlays/overlays.h"
#include "program/load.h"
#include "view_files.h"
#include "viewer/labels.h"

namespace quintet::viewer {
namespace {

constexpr const char* kLessonFolder = "lessons/";

constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

void place(const Area& area) {
  ImGui::SetNextWindowPos({area.origin.x, area.origin.y});
  ImGui::SetNextWindowSize({area.size.x, area.size.y});
}

void heading(const char* text) {
  ImGui::Spacing();
  ImGui::TextDisabled("%s", text);
  ImGui::Separator();
}

void recentFiles(ViewState& state) {
  heading("Recent files");
  if (state.settings.recentFiles.empty())
    ImGui::TextWrapped("Drop a .glb, .gltf or .scene.toml file on the window, or press Ctrl+O.");
  const std::vector<std::string> files = state.settings.recentFiles;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::filesystem::path path = files[i];
    std::error_code error;
    const bool exists = std::filesystem::exists(path, error);
    const bool isBuiltIn = files[i].starts_with(kLessonFolder);
    ImGui::BeginDisabled(!exists && !isBuiltIn);
    const std::string name = isBuiltIn ? files[i] : path.filename().string();
    if (ImGui::Selectable(fmt::format("{}##{}", name, i).c_str())) {
      openRecent(state, files[i]);
    }
    ImGui::EndDisabled();
    tooltip(exists || isBuiltIn ? files[i] : files[i] + " no longer exists");
  }
}

}  // namespace

std::vector<Lesson> lessons() {
  std::vector<Lesson> result;
  for (const std::string& name : program::builtInPrograms()) {
    if (!name.starts_with(kLessonFolder)) continue;
    Lesson lesson;
    lesson.program = name;
    std::string title = name.substr(std::string(kLessonFolder).size());
    std::ranges::replace(title, '_', ' ');
    if (const std::size_t space = title.find(' '); space != std::string::npos)
      title = title.substr(0, space) + " · " + title.substr(space + 1);
    lesson.title = title;
    try {
      lesson.text = program::loadProgram(name).description;
      // "Lesson 05: shadow. …" repeats the title.
      if (const std::size_t colon = lesson.text.find(": "); lesson.text.starts_with("Lesson ") && colon < 12)
        lesson.text.erase(0, colon + 2);
      lesson.text = capitalized(lesson.text);
    } catch (const Error&) {
      continue;  // a program that cannot be read is no lesson
    }
    result.push_back(std::move(lesson));
  }
  return result;
}

void startScreen(ViewState& state, const Area& area, const std::vector<Lesson>& lessons) {
  place(area);
  ImGui::Begin("start", nullptr, kPlain);
  const float width = std::min(area.size.x - 24.0f * state.scale, 1100.0f * state.scale);
  const float left = std::max(0.5f * (area.size.x - width), ImGui::GetStyle().WindowPadding.x);
  ImGui::SetCursorPos({left, std::max(0.08f * area.size.y, 12.0f * state.scale)});
  ImGui::BeginGroup();
  ImGui::PushFont(ImGui::GetIO().Fonts->Fonts.back());  // that of titles
  ImGui::TextUnformatted("Quintet");
  ImGui::PopFont();
  ImGui::TextDisabled("Open a scene or a program, or start with a lesson.");
  ImGui::EndGroup();
  ImGui::SetCursorPosX(left);
  const float height = std::max(ImGui::GetContentRegionAvail().y - 16.0f * state.scale, 1.0f);
  const float column = 0.36f * (width - 24.0f * state.scale);
  ImGui::BeginChild("recent", {column, height}, false);
  recentFiles(state);
  ImGui::EndChild();
  ImGui::SameLine(0.0f, 24.0f * state.scale);
  ImGui::BeginChild("lessons", {width - column - 24.0f * state.scale, height}, false);
  heading("Lessons");
  for (const Lesson& lesson : lessons) {
    if (ImGui::Selectable(lesson.title.c_str())) openLesson(state, lesson.program);
    logControl(lesson.program.c_str());
    tooltip(lesson.text);
    ImGui::SameLine(170.0f * state.scale);
    ImGui::TextDisabled("%s", fittingText(lesson.text, ImGui::GetContentRegionAvail().x).c_str());
  }
  ImGui::EndChild();
  ImGui::End();
}

void loadingScreen(const ViewState& state, const Area& area) {
  place(area);
  ImGui::Begin("loading", nullptr, kPlain);
  // The time is shown if it is long enough to be of interest.
  constexpr double kShownSeconds = 2.0;
  const double seconds = state.loadingSince ? state.time - *state.loadingSince : 0.0;
  const std::string text = seconds < kShownSeconds
                               ? fmt::format("{}...", capitalized(state.snapshot->stage))
                               : fmt::format("{}... {:.0f} s", capitalized(state.snapshot->stage), seconds);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float barWidth = 220.0f * state.scale;
  ImGui::SetCursorPos({0.5f * (area.size.x - size.x), 0.5f * area.size.y - size.y});
  ImGui::TextUnformatted(text.c_str());
  // A bar that moves: the length of the work is not known.
  const ImVec2 at{area.origin.x + 0.5f * (area.size.x - barWidth), area.origin.y + 0.5f * area.size.y + 0.8f * size.y};
  const float thickness = 3.0f * state.scale;
  const auto phase = static_cast<float>(0.5 - 0.5 * std::cos(2.0 * state.time));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + barWidth, at.y + thickness}, ImGui::GetColorU32(ImGuiCol_FrameBg), thickness);
  const float start = at.x + 0.7f * barWidth * phase;
  list.AddRectFilled({start, at.y}, {start + 0.3f * barWidth, at.y + thickness}, ImGui::GetColorU32(ImGuiCol_CheckMark),
                     thickness);
  ImGui::End();
}

void failureScreen(ViewState& state, const Area& area) {
  place(area);
  ImGui::Begin("failure", nullptr, kPlain);
  const float width = std::min(area.size.x - 20.0f, 720.0f * state.scale);
  const float left = 0.5f * (area.size.x - width);
  ImGui::SetCursorPos({left, 0.25f * area.size.y});
  ImGui::BeginChild("message", {width, 0.6f * area.size.y}, false);
  ImGui::PushFont(ImGui::GetIO().Fonts->Fonts.back());            // that of titles
  const bool inProgram = hasErrors(state.snapshot->diagnostics);  // the drawer lists them
  ImGui::TextColored(palette(state.settings.theme).error, "%s",
                     inProgram ? "The program has errors" : "The scene cannot be shown");
  ImGui::PopFont();
  ImGui::Spacing();
  ImGui::PushTextWrapPos(0.0f);
  std::string text = inProgram ? "" : state.snapshot->error;
  if (inProgram || state.snapshot->reopensAfterSave)
    text += (text.empty() ? "" : ".\n") + std::string("It is opened again as soon as one of its files is saved.");
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::Spacing();
  ImGui::Spacing();
  if (button("Try again", "Load scene and program again", state.snapshot->request != nullptr)) state.session->retry();
  ImGui::SameLine();
  if (button("Open...", "Open another file (Ctrl+O)")) state.requests.push_back(Action::open);
  ImGui::EndChild();
  ImGui::End();
}

}  // namespace quintet::viewer
