// Which scene a program brings along.
#include "program_test_support.h"

#include "base/error.h"

namespace quintet::program {
namespace {

const std::string kHead = "[program]\nray_generation = \"main.rgen\"\n";
const std::string kRay = "[[ray]]\nname = \"radiance\"\nmiss = \"sky.rmiss\"\n";

Program parse(const std::string& head, std::map<std::string, std::string> more) {
  more.insert({{"main.rgen", ""}, {"sky.rmiss", ""}});
  return parseProgram(head + kRay, "p", "p", std::move(more));
}

TEST(DefaultScene, IsTheOnlySceneFile) {
  EXPECT_EQ(parse(kHead, {}).scene, "");
  EXPECT_EQ(parse(kHead, {{"a.scene.toml", ""}, {"b.toml", ""}}).scene, "a.scene.toml");
  EXPECT_EQ(parse(kHead, {{"a.scene.toml", ""}, {"b.scene.toml", ""}}).scene, "");
}

TEST(DefaultScene, IsWhatTheProgramNames) {
  EXPECT_EQ(parse(kHead + "scene = \"b.scene.toml\"\n", {{"a.scene.toml", ""}, {"b.scene.toml", ""}}).scene,
            "b.scene.toml");
  try {
    parse(kHead + "scene = \"c.scene.toml\"\n", {{"a.scene.toml", ""}});
    FAIL() << "accepted";
  } catch (const FileError& error) {
    EXPECT_STREQ(error.what(), "p/program.toml: line 3: there is no file 'c.scene.toml' in p");
  }
}

}  // namespace
}  // namespace quintet::program
