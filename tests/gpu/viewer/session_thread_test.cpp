// SPDX-License-Identifier: Apache-2.0
#include "viewer/session_thread.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "harness.h"
#include "io/codec.h"
#include "overlay/window_shaders.h"
#include "temp_folder.h"

namespace quintet::viewer {
namespace {

using namespace job::interactive;
using testing::HasSubstr;

constexpr uvec2 kThreadSize{48, 32};

constexpr const char* kThreadScene = R"(
[[material]]
name = "paint"
[[mesh]]
name = "wall"
positions = [[-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0]]
indices = [[0, 1, 2], [0, 2, 3]]
material = "paint"
[[instance]]
of = "wall"
[[camera]]
look_from = [0, 0, 4]
look_at = [0, 0, 0]
fov = 40
)";

class SessionThreadTest : public testing::Test {
 protected:
  SessionThreadTest() {
    writeFile(folder_ / "wall.scene.toml", kThreadScene);
    SessionThread::Options options;
    options.engine.device = test::testContext().info().name;
    options.onEvent = [this](const std::string& json) {
      const std::lock_guard lock(mutex_);
      events_.push_back(json);
    };
    thread_ = std::make_unique<SessionThread>(std::move(options));
  }

  SessionRequest request() {
    SessionRequest result;
    result.program = "normals";
    result.render.scene = folder_ / "wall.scene.toml";
    result.render.size = kThreadSize;
    result.render.limits.samples = 8;
    return result;
  }

  // Waits for a snapshot with this property.
  std::shared_ptr<const Snapshot> waitFor(const std::function<bool(const Snapshot&)>& matches) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    for (;;) {
      std::shared_ptr<const Snapshot> snapshot = thread_->snapshot();
      if (matches(*snapshot)) return snapshot;
      if (std::chrono::steady_clock::now() > end) {
        ADD_FAILURE() << "no such snapshot: phase " << static_cast<int>(snapshot->phase) << " " << snapshot->error;
        return snapshot;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  std::shared_ptr<const Snapshot> waitForImage() {
    return waitFor([](const Snapshot& snapshot) { return snapshot.image && snapshot.progress.complete; });
  }
  // Waits for a message that contains `part`.
  bool hasMessage(Message::Kind kind, const std::string& part) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (std::chrono::steady_clock::now() < end) {
      for (const Message& message : thread_->takeMessages())
        if (message.kind == kind && message.text.find(part) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  static vec3 middle(const Snapshot& snapshot) {
    const auto pixel = snapshot.image->pixel<float>(snapshot.image->width / 2, snapshot.image->height / 2);
    return {pixel[0], pixel[1], pixel[2]};
  }

  test::TempFolder folder_;
  std::mutex mutex_;
  std::vector<std::string> events_;
  std::unique_ptr<SessionThread> thread_;
};

TEST_F(SessionThreadTest, RendersAndAppliesCommands) {
  EXPECT_EQ(thread_->snapshot()->phase, Snapshot::Phase::empty);
  thread_->apply(Orbit{1, 0});  // without a session it has no effect
  thread_->open(request());
  const auto first = waitForImage();
  EXPECT_EQ(first->image->width, kThreadSize.x);
  EXPECT_EQ(first->progress.samples, 8u);
  EXPECT_NEAR(middle(*first).b, 1.0f, 0.02f) << "the normal is +z";
  EXPECT_EQ(first->scene->instances.size(), 1u);
  EXPECT_EQ(first->scene->materialNames.front(), "paint");
  EXPECT_FALSE(first->canUndo);
  EXPECT_GT(first->scene->size, 8.0f);

  thread_->apply(Orbit{30, 0});
  const auto turned = waitFor(
      [&](const Snapshot& s) { return s.canUndo && s.progress.complete && s.imageNumber > first->imageNumber; });
  EXPECT_NE(turned->state.camera.lookFrom, first->state.camera.lookFrom);
  thread_->apply(Undo{});
  const auto undone = waitFor(
      [&](const Snapshot& s) { return s.canRedo && s.progress.complete && s.imageNumber > turned->imageNumber; });
  EXPECT_EQ(undone->image->data, first->image->data) << "the same image";
  const std::lock_guard lock(mutex_);
  EXPECT_THAT(events_, testing::Contains(HasSubstr("\"restarted\"")));
  EXPECT_THAT(events_, testing::Contains(HasSubstr("\"complete\":true")));
}

// As a window does that had to replace its process: nothing is rendered until a save, and then with the edits.
TEST_F(SessionThreadTest, OpensAfterASave) {
  const std::filesystem::path file = folder_ / "own.rt.glsl";
  const std::string text = "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(0.25)); }\n";
  writeFile(file, text);
  SessionRequest own = request();
  own.program = file.string();
  thread_->openAfterSave(own, {R"({"do":"exposure","stops":2})", R"({"do":"nothing"})"}, "it did not end",
                         {{Severity::error, file.string(), 0, 0, "HANG", "it did not end"}});
  const auto failed = waitFor([](const Snapshot& s) { return s.phase == Snapshot::Phase::failed; });
  EXPECT_EQ(failed->error, "it did not end");
  EXPECT_TRUE(failed->reopensAfterSave);
  EXPECT_EQ(failed->diagnostics.size(), 1u);
  EXPECT_FALSE(thread_->savedWhileBlocked());
  writeFile(file, text + "\n");
  const auto opened = waitForImage();
  EXPECT_NEAR(middle(*opened).r, 0.050876f, 1e-5f) << "0.25 in sRGB";
  EXPECT_TRUE(hasMessage(Message::Kind::error, "nothing")) << "a command that fails is a message";
  EXPECT_EQ(waitFor([](const Snapshot& s) { return s.state.exposure == 2.0; })->undoName, "exposure");
}

TEST_F(SessionThreadTest, PicksWithoutMovingTheCamera) {
  thread_->open(request());
  waitForImage();
  thread_->pick(kThreadSize / 2u, PickUse::select);
  std::vector<std::optional<Pick>> picks;
  for (int i = 0; i < 10000 && picks.empty(); ++i) {
    picks = thread_->takePicks();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_EQ(picks.size(), 1u);
  ASSERT_TRUE(picks[0]);
  EXPECT_EQ(picks[0]->instance, 0u);
  EXPECT_NEAR(picks[0]->distance, 4.0f, 0.05f);
  thread_->pick({0, 0}, PickUse::focus);
  const auto focused = waitFor([](const Snapshot& s) { return s.state.orbitCenter.has_value(); });
  EXPECT_NEAR(focused->state.orbitCenter->z, 0.0f, 1e-3f);
}

TEST_F(SessionThreadTest, FindsTheDepthsOfTheView) {
  thread_->open(request());
  EXPECT_FALSE(waitForImage()->depth) << "nothing asked for it";
  thread_->showDepth(true);
  const auto shown = waitFor([](const Snapshot& s) { return s.depth != nullptr; });
  EXPECT_EQ(shown->depth->size, kThreadSize);
  EXPECT_NEAR(shown->depth->depths[kThreadSize.y / 2 * kThreadSize.x + kThreadSize.x / 2], 4.0f, 0.01f);
  EXPECT_EQ(shown->depth->camera.worldFromCamera, shown->camera.worldFromCamera);
  thread_->apply(SetExposure{1.0});
  EXPECT_EQ(waitFor([](const Snapshot& s) { return s.state.exposure == 1.0; })->depth, shown->depth)
      << "the view is the same";
  thread_->apply(Zoom{2.0f, std::nullopt});
  const auto moved = waitFor([&](const Snapshot& s) { return s.depth && s.depth != shown->depth; });
  EXPECT_NEAR(moved->depth->depths[kThreadSize.y / 2 * kThreadSize.x + kThreadSize.x / 2], 2.0f, 0.01f);
  thread_->showDepth(false);
  EXPECT_FALSE(waitFor([](const Snapshot& s) { return !s.depth; })->depth);
}

TEST_F(SessionThreadTest, SavesTheCompleteSize) {
  thread_->open(request());
  thread_->apply(SetExposure{1.0});
  thread_->save(folder_ / "out.png");
  EXPECT_TRUE(hasMessage(Message::Kind::note, "out.png"));
  thread_->save(folder_ / "out.exr");
  EXPECT_TRUE(hasMessage(Message::Kind::note, "out.exr"));
  EXPECT_EQ(io::readImage(folder_ / "out.png").width, kThreadSize.x);
  EXPECT_EQ(io::readImage(folder_ / "out.exr").height, kThreadSize.y);
}

TEST_F(SessionThreadTest, AFailedSaveDoesNotDiscardTheNextOne) {
  thread_->open(request());
  thread_->save(folder_ / "no/folder.png");
  thread_->save(folder_ / "out.png");
  EXPECT_TRUE(hasMessage(Message::Kind::note, "out.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.png"));
}

TEST_F(SessionThreadTest, ReportsErrorsAndContinues) {
  thread_->open(request());
  waitForImage();
  thread_->apply(SetParameter{"missing", "1"});
  EXPECT_TRUE(hasMessage(Message::Kind::error, "missing"));
  thread_->save(folder_ / "no/folder.png");
  EXPECT_TRUE(hasMessage(Message::Kind::error, "folder"));
  EXPECT_EQ(thread_->snapshot()->phase, Snapshot::Phase::ready);

  SessionRequest wrong = request();
  wrong.render.scene = folder_ / "missing.glb";
  thread_->open(wrong);
  const auto failed = waitFor([](const Snapshot& s) { return s.phase == Snapshot::Phase::failed; });
  EXPECT_THAT(failed->error, HasSubstr("missing.glb"));
  thread_->apply(Orbit{1, 0});
  thread_->open(request());
  EXPECT_EQ(waitForImage()->session, 3u);
}

TEST_F(SessionThreadTest, ExplainsAndNoticesChanges) {
  thread_->open(request());
  thread_->explain(kThreadSize / 2u, 3);
  const auto first = waitFor([](const Snapshot& s) { return s.explanation && s.progress.complete; });
  EXPECT_EQ(first->explanation->pixel, kThreadSize / 2u);
  EXPECT_EQ(first->explanation->sample, 3u);
  EXPECT_NEAR(first->explanation->outputs.at(0).value.z, 1.0f, 1e-3f) << "the normal is +z";
  EXPECT_FALSE(first->explanationOutdated);
  EXPECT_TRUE(first->explanationUsesCamera);
  thread_->apply(SetExposure{1.0});
  waitFor([](const Snapshot& s) { return s.state.exposure == 1.0; });
  EXPECT_FALSE(thread_->snapshot()->explanationOutdated) << "the samples are the same";
  thread_->apply(Orbit{30, 0});
  const auto turned = waitFor([](const Snapshot& s) { return s.explanationOutdated; });
  EXPECT_EQ(turned->explanation, first->explanation) << "it stays until the next request";
  EXPECT_TRUE(turned->explanationUsesCamera) << "that of the explained image";
  thread_->explain(kThreadSize / 2u, 3);
  const auto second = waitFor([&](const Snapshot& s) { return s.explanation && s.explanation != first->explanation; });
  EXPECT_FALSE(second->explanationOutdated);
  EXPECT_FALSE(second->explaining);
  thread_->explain(kThreadSize, 0);
  EXPECT_TRUE(hasMessage(Message::Kind::error, "is not inside"));
  EXPECT_EQ(thread_->snapshot()->explanation, nullptr);
}

TEST_F(SessionThreadTest, RaysAreThoseOfTheProgram) {
  const std::string file = (folder_ / "own.rt.glsl").string();
  const auto save = [&](const char* color) {
    writeFile(file,
              std::string("void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(") + color + "));\n}\n");
  };
  save("1.0");
  thread_->open(request());
  thread_->explain(kThreadSize / 2u, 3);
  EXPECT_TRUE(waitFor([](const Snapshot& s) { return s.explanation != nullptr; })->explanationUsesCamera);
  thread_->apply(SetProgram{file});
  const auto changed = waitFor([&](const Snapshot& s) { return s.state.program == file; });
  EXPECT_NE(changed->explanation, nullptr);
  EXPECT_FALSE(changed->explanationUsesCamera) << "the rays do not fit the image of the new program";
  thread_->explain(kThreadSize / 2u, 0);
  const auto own = waitFor([&](const Snapshot& s) { return s.explanation && s.explanation != changed->explanation; });
  EXPECT_FALSE(own->explanationUsesCamera) << "no ray at all";
}

TEST_F(SessionThreadTest, CollectsWhatIsPrinted) {
  writeFile(folder_ / "say.rt.glsl",
            "void main() { /**** RAY GENERATION SHADER ****/\n  debugPrintfEXT(\"frame %d\", frameID);\n"
            "  gsnSetPixel(vec4(1.0));\n}\n");
  SessionRequest say = request();
  say.program = (folder_ / "say.rt.glsl").string();
  thread_->open(say);
  EXPECT_TRUE(waitForImage()->callsPrint);
  thread_->apply(SetPrint{job::PrintRequest{.pixels = {3, 4, 1, 1}, .limit = 5}});
  const auto printed = waitFor([](const Snapshot& s) { return s.printed && s.progress.complete; });
  ASSERT_EQ(printed->printed->lines.size(), 5u) << "of all batches";
  EXPECT_EQ(printed->printed->lines[4].text, "frame 4");
  EXPECT_EQ(printed->printed->omitted, 3u);
  thread_->apply(SetPrint{});
  waitFor([](const Snapshot& s) { return !s.print && !s.printed; });
}

TEST_F(SessionThreadTest, KeepsTheLastProgramThatCompiles) {
  const auto program = [](const std::string& color) {
    return "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(" + color + ", 1.0));\n}\n";
  };
  writeFile(folder_ / "flat.rt.glsl", program("vec3(1, 0, 0)"));
  SessionRequest flat = request();
  flat.program = (folder_ / "flat.rt.glsl").string();
  thread_->open(flat);
  const auto first = waitForImage();
  EXPECT_EQ(middle(*first), vec3(1, 0, 0));
  writeFile(folder_ / "flat.rt.glsl", program("missing"));
  const auto broken = waitFor([](const Snapshot& s) { return s.outdatedProgram; });
  EXPECT_EQ(middle(*broken), vec3(1, 0, 0));
  EXPECT_THAT(broken->diagnostics.front().file, HasSubstr("flat.rt.glsl"));
  EXPECT_EQ(broken->diagnostics.front().line, 2);
  writeFile(folder_ / "flat.rt.glsl", program("vec3(0, 1, 0)"));
  const auto fixed = waitFor([&](const Snapshot& s) {
    return !s.outdatedProgram && s.progress.complete && s.imageNumber > broken->imageNumber;
  });
  EXPECT_EQ(middle(*fixed), vec3(0, 1, 0));
  EXPECT_FALSE(hasErrors(fixed->diagnostics));
}

// The program compiles only for scenes without clear coat.
TEST_F(SessionThreadTest, AFailureStaysUntilTheSessionRestarts) {
  const std::string program =
      "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(1.0, 0.0, 0.0, 1.0));\n}\n";
  writeFile(folder_ / "flat.rt.glsl", "#ifndef QUINTET_NO_CLEARCOAT\n#error no clear coat\n#endif\n" + program);
  SessionRequest flat = request();
  flat.program = (folder_ / "flat.rt.glsl").string();
  thread_->open(flat);
  const auto first = waitForImage();
  thread_->apply(EditMaterial{"paint", {{"clearcoat", {1}}}});
  waitFor([](const Snapshot& s) { return !s.renderError.empty(); });
  thread_->apply(EndDrag{});
  thread_->apply(SetExposure{1});
  const auto failed = waitFor([](const Snapshot& s) { return s.state.exposure == 1; });
  EXPECT_NE(failed->renderError, "") << "these commands do not restart the render";
  thread_->save(folder_ / "out.png");
  EXPECT_TRUE(hasMessage(Message::Kind::error, "out.png: not saved, because the render failed"));
  writeFile(folder_ / "flat.rt.glsl", program);
  const auto corrected =
      waitFor([&](const Snapshot& s) { return s.progress.complete && s.imageNumber > first->imageNumber; });
  EXPECT_EQ(corrected->renderError, "");
}

TEST_F(SessionThreadTest, OpensAProgramAsSoonAsItIsCorrected) {
  const auto program = [](const std::string& color) {
    return "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(" + color + ", 1.0));\n}\n";
  };
  writeFile(folder_ / "flat.rt.glsl", program("missing"));
  SessionRequest flat = request();
  flat.program = (folder_ / "flat.rt.glsl").string();
  thread_->open(flat);
  waitFor([](const Snapshot& s) { return s.phase == Snapshot::Phase::failed; });
  writeFile(folder_ / "flat.rt.glsl", program("vec3(0, 1, 0)"));
  EXPECT_EQ(middle(*waitForImage()), vec3(0, 1, 0));

  // The same for another program in the session.
  writeFile(folder_ / "other.rt.glsl", program("nothing"));
  thread_->apply(SetProgram{(folder_ / "other.rt.glsl").string()});
  const auto failed = waitFor([](const Snapshot& s) { return hasErrors(s.diagnostics); });
  EXPECT_EQ(failed->phase, Snapshot::Phase::ready);
  EXPECT_EQ(failed->state.program, flat.program);
  thread_->apply(SetExposure{1.0});  // not an edit
  const auto bright =
      waitFor([&](const Snapshot& s) { return s.state.exposure == 1.0 && s.imageNumber > failed->imageNumber; });
  writeFile(folder_ / "other.rt.glsl", program("vec3(0, 0, 1)"));
  const auto other = waitFor([&](const Snapshot& s) {
    return s.state.program != flat.program && s.progress.complete && s.imageNumber > bright->imageNumber;
  });
  EXPECT_EQ(middle(*other), vec3(0, 0, 1));
  EXPECT_TRUE(other->canUndo);
}

TEST_F(SessionThreadTest, AnEditEndsTheRetriesOfAProgram) {
  const auto program = [](const std::string& color) {
    return "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(" + color + ", 1.0));\n}\n";
  };
  const std::string file = (folder_ / "other.rt.glsl").string();
  writeFile(file, program("nothing"));
  thread_->open(request());
  thread_->apply(SetProgram{file});
  EXPECT_TRUE(hasMessage(Message::Kind::error, "other.rt.glsl"));
  thread_->apply(Orbit{10, 0});
  waitFor([](const Snapshot& s) { return s.canUndo; });
  writeFile(file, program("vec3(0, 0, 1)"));
  for (const double stops : {1.0, 2.0, 3.0}) {  // a retry would be in between
    thread_->apply(SetExposure{stops});
    EXPECT_EQ(waitFor([&](const Snapshot& s) { return s.state.exposure == stops; })->state.program, "normals");
  }
}

TEST_F(SessionThreadTest, OpensAProgramAsSoonAsItHasTheParameter) {
  const std::string main = "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(vec3(";
  const std::string end = "), 1.0));\n}\n";
  writeFile(folder_ / "flat.rt.glsl", main + "0.0" + end);
  SessionRequest flat = request();
  flat.program = (folder_ / "flat.rt.glsl").string();
  flat.render.assignments = {"gray=1"};
  thread_->open(flat);
  waitFor([](const Snapshot& s) { return s.phase == Snapshot::Phase::failed; });
  writeFile(folder_ / "flat.rt.glsl",
            "/**** COMMON START ****/\nuniform float gray;  // defaultval=\"0.5\"\n/**** COMMON END ****/\n" + main +
                "gray" + end);
  EXPECT_EQ(middle(*waitForImage()), vec3(1.0f));
}

TEST(WindowShaders, Compile) {
  const overlay::WindowShaders shaders = overlay::compileWindowShaders({});
  EXPECT_FALSE(shaders.vertex.empty());
  EXPECT_FALSE(shaders.fragment.empty());
}

}  // namespace
}  // namespace quintet::viewer
