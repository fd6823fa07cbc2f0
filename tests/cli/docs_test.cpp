// SPDX-License-Identifier: Apache-2.0
// The commands of docs/farm.md and docs/cli.md that render, merge and plan, in the order of the pages and in one folder. They
// run as written, with further options behind their own that make them short.
#include <sys/wait.h>

#include <cstdlib>
#include <regex>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/file.h"
#include "base/parse.h"
#include "base/text.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

// The quad, moved along x from 0 to 1 s by the animation "Run".
nlohmann::json animatedQuad() {
  nlohmann::json json = quadScene();
  const float values[] = {0, 2, 0, 0, 0, 1, 0, 0};  // two times, two translations
  const std::size_t buffer = json["buffers"].size(), view = json["bufferViews"].size(),
                    accessor = json["accessors"].size();
  json["buffers"].push_back({{"byteLength", sizeof values},
                             {"uri", "data:application/octet-stream;base64," +
                                         base64({reinterpret_cast<const char*>(values), sizeof values})}});
  json["bufferViews"].push_back({{"buffer", buffer}, {"byteLength", 8}});
  json["bufferViews"].push_back({{"buffer", buffer}, {"byteOffset", 8}, {"byteLength", 24}});
  json["accessors"].push_back(
      {{"bufferView", view}, {"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}, {"min", {0}}, {"max", {2}}});
  json["accessors"].push_back({{"bufferView", view + 1}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}});
  std::size_t node = 0;
  while (!json["nodes"][node].contains("mesh")) ++node;
  json["animations"] = {{{"name", "Run"},
                         {"samplers", {{{"input", accessor}, {"output", accessor + 1}}}},
                         {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}}}}};
  return json;
}

class DocumentedCommands : public CliTest {
 protected:
  DocumentedCommands() {
    write(folder_ / "scene.glb", glb(quadScene(), ""));
    write(folder_ / "fox.glb", glb(animatedQuad(), ""));
    std::filesystem::create_directories(folder_ / "models");
    write(folder_ / "models/a.glb", glb(quadScene(), ""));
    write(folder_ / "models/b.glb", glb(quadScene(), ""));
    write(folder_ / "moving.scene.toml",
          "[[file]]\nname = \"quad\"\npath = \"scene.gltf\"\n[[instance]]\nof = \"quad\"\n"
          "keyframes = [{ frame = 0 }, { frame = 2, translate = [0.5, 0.0, 0.0] }]\n"
          "[[camera]]\nlook_from = [0, 0, 4]\nlook_at = [0, 0, 0]\n");
    // Of options that are given twice, the last one counts.
    write(folder_ / "quintet",
          "#!/usr/bin/env bash\n"
          "more=()\n"
          "case \"$*\" in\n"
          "  *--adaptive*) more=(--size 16x9 --until-error 0.9) ;;\n"
          "  'render '*--batches*) more=(--size 16x9 --program normals) ;;\n"
          "  'render '*--time*) more=(--size 16x9 --program normals --time 0.1) ;;\n"
          "  'render '*) more=(--size 16x9 --program normals --spp 8) ;;\n"
          "  'farm plan '*--frames*) more=(--size 16x9 --program normals --spp 4 --frames 0-7 --parts 4) ;;\n"
          "  'farm plan '*) more=(--size 16x9 --program normals --spp 16 --parts 4) ;;\n"
          "esac\n"
          "if [[ $* == 'farm merge farm' ]]; then for i in 0 1 2; do " +
              shellQuoted(QUINTET_BINARY) + " farm run -q farm $i; done; fi\n" + "exec " + shellQuoted(QUINTET_BINARY) +
              " \"$@\" \"${more[@]}\"\n");
    std::filesystem::permissions(folder_ / "quintet", std::filesystem::perms(0755));
  }
  // The status; the output is in the file "output".
  int shell(const std::string& line) const {
    const std::string command = "cd " + shellQuoted(folder_.path().string()) + " && PATH=.:$PATH && " + line;
    const std::string redirected =
        "bash -c " + shellQuoted(command) + " > " + shellQuoted((folder_ / "output").string()) + " 2>&1 < /dev/null";
    return WEXITSTATUS(std::system(redirected.c_str()));
  }
  void runCommandsOf(const std::string& page) {
    // What this machine may not have: other devices, ffmpeg; and lines that describe a form.
    std::string skipped = "0,2|h200|SCENE|checkpoint\\.qfilm";
    if (shell("command -v ffmpeg") != 0) skipped += "|\\.mp4";
    const std::regex command("    quintet (render|merge|farm plan|farm run|farm status|farm merge|info)( .*|$)"),
        absent(skipped);
    std::size_t count = 0;
    for (const std::string& line :
         splitText(readTextFile(std::filesystem::path(QUINTET_SOURCE_ROOT) / "docs" / page), '\n')) {
      if (!std::regex_match(line, command) || std::regex_search(line, absent)) continue;
      ++count;
      EXPECT_EQ(shell(line), 0) << page << ": " << line << "\n" << readTextFile(folder_ / "output");
    }
    EXPECT_GT(count, 10u);
  }
};

TEST_F(DocumentedCommands, OfFarmWork) {
  runCommandsOf("farm.md");
  // The checkpoint of an unfinished render.
  ASSERT_EQ(shell("quintet render scene.glb --spp 64 --batches 0-7 -o scene.checkpoint.qfilm"), 0);
  EXPECT_EQ(shell("quintet merge scene.checkpoint.qfilm --partial -o preview.png"), 0);
}

TEST_F(DocumentedCommands, OfTheCommandLineWork) {
  ASSERT_EQ(shell("quintet render scene.glb --spp 64 --batches 0-7 -o a.qfilm && "
                  "quintet render scene.glb --spp 64 --batches 8-15 -o b.qfilm"),
            0);
  runCommandsOf("cli.md");
}

}  // namespace
}  // namespace quintet::test
