// SPDX-License-Identifier: Apache-2.0
// Several scenes, one after the other: what a failure stops. The engine opens no device here.
#include "job/scene_batch.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include <quintet/device.h>

#include "base/error.h"
#include "gpu/error.h"

namespace quintet::job {
namespace {

using testing::ElementsAre;

class SceneBatchTest : public testing::Test {
 protected:
  // Renders five scenes, of which the second one does what `second` does.
  SceneBatchResult render(const std::function<SceneEnd()>& second, std::size_t first = 0) {
    SceneBatch batch;
    batch.count = 5;
    batch.first = first;
    batch.render = [&](std::size_t scene) {
      begun_.push_back(scene);
      return scene == 1 ? second() : SceneEnd::rendered;
    };
    batch.failed = [&](std::size_t scene, const std::exception& error) {
      reported_.push_back(std::to_string(scene) + " " + error.what());
    };
    return renderScenes(engine_, batch);
  }

  Engine engine_{{.device = "none of this name", .caches = {}}};
  std::vector<std::size_t> begun_;
  std::vector<std::string> reported_;
};

TEST_F(SceneBatchTest, AFailureDoesNotStopTheOthers) {
  const std::vector<std::function<SceneEnd()>> failures{
      []() -> SceneEnd { throw FileError("b.glb", "cannot be read"); },
      []() -> SceneEnd { throw UsageError("camera 'x' not found"); },
      []() -> SceneEnd { throw MemoryError("too large"); }, []() -> SceneEnd { throw std::bad_alloc(); },
      []() -> SceneEnd { throw DeviceLostError("lost"); }};
  for (const auto& failure : failures) {
    begun_.clear();
    reported_.clear();
    const SceneBatchResult result = render(failure);
    EXPECT_THAT(begun_, ElementsAre(0u, 1u, 2u, 3u, 4u));
    EXPECT_THAT(result.failed, ElementsAre(1u));
    ASSERT_EQ(reported_.size(), 1u);
    EXPECT_TRUE(reported_[0].starts_with("1 "));
    EXPECT_FALSE(result.interrupted || result.targetMissed);
  }
  reported_.clear();
  EXPECT_THAT(render([] { return SceneEnd::failed; }).failed, ElementsAre(1u));  // reported by render()
  EXPECT_TRUE(reported_.empty());
}

TEST_F(SceneBatchTest, StopsWithoutADeviceAndAfterAnInterruption) {
  EXPECT_THROW(render([]() -> SceneEnd { throw gpu::NoDeviceError("no device"); }), gpu::NoDeviceError);
  EXPECT_THROW(render([]() -> SceneEnd { throw TimeoutError(2); }), TimeoutError);
  begun_.clear();
  const SceneBatchResult result = render([] { return SceneEnd::interrupted; });
  EXPECT_TRUE(result.interrupted);
  EXPECT_TRUE(result.failed.empty());
  EXPECT_THAT(begun_, ElementsAre(0u, 1u));
}

TEST_F(SceneBatchTest, ReportsAMissedTarget) {
  const SceneBatchResult result = render([] { return SceneEnd::targetMissed; });
  EXPECT_TRUE(result.targetMissed);
  EXPECT_TRUE(result.failed.empty());
}

TEST_F(SceneBatchTest, ContinuesAfterTheScenesOfAnEarlierProcess) {
  render([] { return SceneEnd::rendered; }, 3);
  EXPECT_THAT(begun_, ElementsAre(3u, 4u));
}

TEST(FailedScenesText, NamesThem) {
  const std::vector<std::filesystem::path> scenes{"a.glb", "x/b.glb", "c.glb"};
  const std::vector<std::size_t> failed{1, 2};
  EXPECT_EQ(failedScenesText(scenes, failed), "2 of 3 scenes failed: x/b.glb, c.glb");
}

}  // namespace
}  // namespace quintet::job
