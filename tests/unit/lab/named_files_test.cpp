// SPDX-License-Identifier: Apache-2.0
#include "lab/named_files.h"

#include <string>

#include <gmock/gmock.h>

#include "base/file.h"
#include "lab/little_endian.h"
#include "temp_folder.h"

namespace quintet::lab {
namespace {

using ::testing::ElementsAre;

std::string glb(std::string json) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  appendInteger(bytes, 2, 4);
  appendInteger(bytes, 20 + json.size(), 4);
  appendInteger(bytes, json.size(), 4);
  return bytes + "JSON" + json;
}

TEST(NamedFiles, FollowsIncludesAndScenes) {
  const test::TempFolder folder;
  const auto write = [&](const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder / name).parent_path());
    writeFile(folder / name, text);
  };
  write("a.rt.glsl",
        "// scene: a.scene.toml\n#include \"lib/x.glsl\"\n#include \".hidden.glsl\"\n"
        "#include \"../outside.glsl\"\nvoid main() { /**** RAY GENERATION SHADER ****/ }\n");
  write("lib/x.glsl", "#include \"y.glsl\"\n#include \"z.glsl\"\n");
  write("lib/y.glsl", "#include \"x.glsl\"\n");
  write("z.glsl", "");
  write(".hidden.glsl", "");
  write("a.scene.toml", "[[file]]\npath = \"models/a.gltf\"\n");
  write("models/a.gltf",
        R"({"buffers":[{"uri":"a%20b.bin"},{"uri":"missing.bin"}],"images":[{"uri":"data:image/png,"}]})");
  write("models/a b.bin", "");
  write("other.glsl", "");
  write("b.glb", glb(R"({"images":[{"uri":"image.png"}],"extensions":{"X":[{"uri":"x.bin"}]}})"));
  write("image.png", "");
  write("x.bin", "");
  EXPECT_THAT(namedFiles(folder.path(), "a.rt.glsl"),
              ElementsAre("a.rt.glsl", "a.scene.toml", "lib/x.glsl", "lib/y.glsl", "models/a b.bin", "models/a.gltf",
                          "z.glsl"));
  EXPECT_THAT(namedFiles(folder.path(), "b.glb"), ElementsAre("b.glb", "image.png", "x.bin"));
  write("broken.gltf", std::string(100'000, '['));
  EXPECT_THAT(namedFiles(folder.path(), "broken.gltf"), ElementsAre("broken.gltf"));
}

}  // namespace
}  // namespace quintet::lab
