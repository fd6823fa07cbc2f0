// SPDX-License-Identifier: Apache-2.0
// What shaders print, and heat maps, through the API.
#include <gmock/gmock.h>

#include "scenes.h"

namespace quintet::test {
namespace {

constexpr const char* kPrinting = R"(struct RayPayloadType { vec3 color; };
void main() { /**** RAY GENERATION SHADER ****/
  debugPrintfEXT("frame %d", frameID);
  payload.color = vec3(0.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 9, 0), 0.001, vec3(0, -1, 0), 100.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
void main() { /**** MISS SHADER ****/ payload.color = vec3(1.0); }
)";

TEST(ApiPrint, LinesAreInTheReport) {
  const Program program = Program::fromSource(kPrinting, "printing");
  Renderer renderer(device(), Scene::of(program), program,
                    {.width = 8, .height = 4, .print = Region{5, 1, 1, 1}, .printLimit = 3});
  const RenderReport first = renderer.render(2);
  ASSERT_EQ(first.printed.size(), 2u);
  const PrintedLine& line = first.printed[1];
  EXPECT_EQ(line.text, "frame 1");
  EXPECT_EQ(line.x, 5u);
  EXPECT_EQ(line.y, 1u);
  EXPECT_EQ(line.frame, 1u);
  EXPECT_FALSE(line.sample);
  EXPECT_EQ(line.line, 3);
  const RenderReport second = renderer.render(3);
  EXPECT_EQ(second.printed.size(), 1u);
  EXPECT_EQ(second.omittedPrints, 2u);
  renderer.restart();
  EXPECT_EQ(renderer.render(2).printed.size(), 2u);
}

TEST(ApiPrint, PixelsMustBeInTheImage) {
  const Program program = Program::fromSource(kPrinting, "printing");
  const auto make = [&](const Region& pixels) {
    const Renderer renderer(device(), Scene::of(program), program, {.width = 8, .height = 4, .print = pixels});
  };
  EXPECT_THROW(make({0, 0, 0, 1}), UsageError);
  EXPECT_THROW(make({0, 0, 9, 1}), UsageError);
}

TEST(ApiPrint, HeatMapsAreOutputs) {
  const Program program = Program::fromSource(kPrinting, "printing");
  Renderer renderer(device(), Scene::of(program), program, {.width = 8, .height = 4, .outputs = {"heat_rays"}});
  renderer.render(1);
  EXPECT_EQ(renderer.image("heat_rays").at(3, 2)[0], 1.0f);
}

}  // namespace
}  // namespace quintet::test
