// SPDX-License-Identifier: Apache-2.0
// The shaders that the binary contains render the image of those that are compiled from GLSL.
#include <cmath>
#include <string>

#include "demo/test_scenes.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

class ShippedShaders : public CliTest {
 protected:
  io::Image render(const std::string& scene, const std::vector<std::pair<std::string, std::string>>& environment) {
    RunOptions options;
    options.environment = environment;
    const RunResult result = quintet({"render", scene, "--size", "32x24", "--spp", "4", "--env", "0.5,0.6,0.7", "-q",
                                      "-o", "out.exr", "--exr-type", "float"},
                                     options);
    EXPECT_EQ(result.status, 0) << result.err;
    return readImage("out.exr");
  }
};

// Compilers may round differently, so a few paths may end elsewhere.
TEST_F(ShippedShaders, RenderTheSameImage) {
  for (const char* name : {"cornell", "many_lights"}) {
    for (const demo::TestScene& scene : demo::testScenes())
      if (std::string(scene.name) == name) write(folder_ / "a.glb", scene.make());
    const io::Image shipped = render("a.glb", {});
    const io::Image compiled = render("a.glb", {{"QUINTET_NO_SHIPPED_SHADERS", "1"}});
    int different = 0;
    double sum = 0;
    for (std::uint32_t y = 0; y < 24; ++y)
      for (std::uint32_t x = 0; x < 32; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          const float a = shipped.pixel<float>(x, y)[c], b = compiled.pixel<float>(x, y)[c];
          different += std::abs(a - b) > 1e-4f * (0.1f + std::abs(b));
          sum += a;
        }
    EXPECT_GT(sum, 10.0) << name;
    EXPECT_LE(different, 3 * 8) << name;  // of 768 pixels with three channels
  }
}

}  // namespace
}  // namespace quintet::test
