// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/command_json.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "job/interactive/event_json.h"

namespace quintet::job::interactive {
namespace {

using testing::AllOf;
using ::testing::HasSubstr;

Command parse(const std::string& line) { return parseCommand(scriptSchema().readCommand(line)); }

std::string errorOf(const std::string& line) {
  try {
    parse(line);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CommandJson, ReadsCommands) {
  const auto orbit = std::get<Orbit>(parse(R"({"do":"orbit","dx":30,"dy":-5})"));
  EXPECT_EQ(orbit.right, 30.0f);
  EXPECT_EQ(orbit.up, -5.0f);
  EXPECT_EQ(std::get<Zoom>(parse(R"({"do":"zoom","factor":2,"x":3,"y":4})")).pixel, vec2(3, 4));
  EXPECT_EQ(std::get<SetSize>(parse(R"({"do":"size","width":8,"height":6})")).size, uvec2(8, 6));
  EXPECT_EQ(std::get<SetCamera>(parse(R"({"do":"camera","name":"side"})")).camera.name, "side");
  EXPECT_EQ(std::get<SetCamera>(parse(R"({"do":"look","from":[1,2,3]})")).camera.lookFrom, vec3(1, 2, 3));
  const auto transform =
      std::get<SetTransform>(parse(R"({"do":"transform","instance":"a","matrix":[1,0,0,7, 0,1,0,8, 0,0,1,9]})"));
  EXPECT_EQ(transform.worldFromObject[3], vec4(7, 8, 9, 1));
}

TEST(CommandJson, ValuesAreAssignments) {
  const auto valueOf = [](const std::string& value) {
    return std::get<SetParameter>(parse(R"({"do":"set","parameter":"p","value":)" + value + "}")).value;
  };
  EXPECT_EQ(valueOf("3"), "3");
  EXPECT_EQ(valueOf("0.1"), "0.1");
  EXPECT_EQ(valueOf("true"), "true");
  EXPECT_EQ(valueOf("[1,0.5,0]"), "1,0.5,0");
  EXPECT_EQ(valueOf("\"fast\""), "fast");
}

TEST(CommandJson, MaterialsTakeAllOtherMembers) {
  const auto edit = std::get<EditMaterial>(parse(R"({"do":"material","name":"Gold","roughness":0.2,"unlit":true})"));
  EXPECT_EQ(edit.material, "Gold");
  ASSERT_EQ(edit.properties.size(), 2u);
  EXPECT_EQ(edit.properties[0].name, "roughness");
  EXPECT_EQ(edit.properties[0].numbers, std::vector<double>{0.2});
  EXPECT_EQ(edit.properties[1].numbers, std::vector<double>{1});
}

TEST(CommandJson, ReadsLights) {
  const auto edit = std::get<EditLight>(parse(R"({"do":"light","name":"sun","color":[1,0.5,0],"on":false})"));
  EXPECT_EQ(edit.light, "sun");
  ASSERT_EQ(edit.properties.size(), 2u);
  EXPECT_EQ(edit.properties[0].numbers, (std::vector<double>{1, 0.5, 0}));
  EXPECT_EQ(edit.properties[1].name, "on");
  EXPECT_EQ(edit.properties[1].numbers, std::vector<double>{0});
  const auto environment = std::get<SetEnvironment>(parse(R"({"do":"environment","source":"a.hdr","rotation":90})"));
  EXPECT_EQ(environment.source, "a.hdr");
  EXPECT_EQ(environment.rotation, 90.0f);
  EXPECT_FALSE(environment.intensity || environment.on);
  EXPECT_EQ(std::get<SetEnvironment>(parse(R"({"do":"environment","on":false})")).on, false);
  EXPECT_EQ(std::get<SetOrbitCenter>(parse(R"({"do":"orbitCenter","point":[1,2,3]})")).point, vec3(1, 2, 3));
  EXPECT_EQ(std::get<SetProgram>(parse(R"({"do":"program","name":"ao"})")).name, "ao");
}

TEST(CommandJson, ReadsThePixelsThatPrint) {
  const auto print = std::get<SetPrint>(parse(R"({"do":"print","x":3,"y":0,"width":2})")).print;
  ASSERT_TRUE(print);
  EXPECT_EQ(print->pixels, (render::Region{3, 0, 2, 1}));
  EXPECT_FALSE(print->all);
  EXPECT_EQ(print->limit, 200u);
  const auto all = std::get<SetPrint>(parse(R"({"do":"print","all":true,"limit":7})")).print;
  EXPECT_TRUE(all->all);
  EXPECT_EQ(all->limit, 7u);
  EXPECT_FALSE(std::get<SetPrint>(parse(R"({"do":"print","on":false})")).print);
  EXPECT_EQ(errorOf(R"({"do":"print","x":3})"), "'y' is missing");
}

TEST(CommandJson, ReadsCommandsWithoutValues) {
  EXPECT_TRUE(std::holds_alternative<Rewind>(parse(R"({"do":"rewind"})")));
  EXPECT_TRUE(std::holds_alternative<Undo>(parse(R"({"do":"undo"})")));
  EXPECT_THAT(errorOf(R"({"do":"rewind","frame":3})"), HasSubstr("unknown key 'frame'"));
}

TEST(CommandJson, RejectsMistakes) {
  EXPECT_EQ(errorOf(R"({"do":"orbti"})"), "unknown command 'orbti' (did you mean 'orbit'?)");
  EXPECT_EQ(errorOf(R"({"do":"refin"})"), "unknown command 'refin' (did you mean 'refine'?)");
  EXPECT_EQ(errorOf(R"({"do":"zoom","facter":2})"), "unknown key 'facter' (did you mean 'factor'?)");
  EXPECT_EQ(errorOf(R"({"do":"output","nmae":"normal"})"), "unknown key 'nmae' (did you mean 'name'?)");
  EXPECT_EQ(errorOf(R"({"do":"output"})"), "'name' is missing");
  EXPECT_THAT(errorOf(R"({"do":"orbit","dx":"a"})"), HasSubstr("'dx' must be a number"));
  EXPECT_THAT(errorOf(R"({"do":"size","width":0,"height":3})"), HasSubstr("'width' must be a whole number from 1"));
  EXPECT_THAT(errorOf(R"({"do":"size","width":1.5,"height":3})"), HasSubstr("whole number"));
  EXPECT_EQ(errorOf(R"({"do":"tonemap","name":"acse"})"), "'name' cannot be 'acse' (did you mean 'aces'?)");
  EXPECT_THAT(errorOf(R"({"do":"transform","instance":"a","matrix":[1]})"),
              HasSubstr("'matrix' must be a list of 12 numbers"));
  EXPECT_THAT(errorOf(R"({"do":"zoom","x":1})"), HasSubstr("require each other"));
  EXPECT_THAT(errorOf(R"({"do":"orbit","dx":1e300})"), AllOf(HasSubstr("'dx'"), HasSubstr("range")));
  EXPECT_THAT(errorOf(R"({"do":"orbit","dx":1e999})"), HasSubstr("a number is out of range"));
  EXPECT_EQ(errorOf(R"({"do":"orbit")"), "byte 14: invalid JSON");
  EXPECT_THAT(errorOf(R"({"do":"environment","on":1})"), HasSubstr("'on' must be true or false"));
  EXPECT_THAT(errorOf(R"({"do":"light","name":"sun"})"), HasSubstr("no value of the light"));
  EXPECT_THAT(errorOf(R"({"do":"lens"})"), HasSubstr("no value of the lens"));
  EXPECT_EQ(errorOf(R"({"do":"lens","fob":40})"), "unknown key 'fob' (did you mean 'fov'?)");
  EXPECT_THAT(errorOf(R"({"do":"environment"})"), HasSubstr("no value of the environment"));
  EXPECT_EQ(errorOf(R"({"do":"environment","of":true})"), "unknown key 'of' (did you mean 'on'?)");
  EXPECT_THAT(errorOf("[]"), HasSubstr("must be a JSON object"));
  EXPECT_EQ(errorOf("{}"), "'do' is missing");
}

TEST(EventJson, IsOneLine) {
  EXPECT_EQ(eventJson(ImageUpdated{4, {8, 6}, 2, false}),
            R"({"event":"image","samples":4,"width":8,"height":6,"factor":2,"complete":false})");
  EXPECT_EQ(eventJson(Restarted{}), R"({"event":"restarted"})");
  EXPECT_THAT(eventJson(DiagnosticsFound{{{Severity::error, "a.rgen", 3, 0, "GLSL", "bad\nword"}}}),
              ::testing::AllOf(HasSubstr(R"("file":"a.rgen","line":3)"), ::testing::Not(HasSubstr("\n"))));
  Pick pick;
  pick.instance = pick.material = 1;
  pick.primitive = 70000;
  pick.position = {1, 2, 3};
  pick.distance = 4;
  const std::string line = pickedJson({5, 6}, pick, {"a", "b"}, {"red", "default"});
  EXPECT_THAT(line, ::testing::StartsWith(R"({"event":"picked","x":5,"y":6,"instance":"b","geometry":0)"));
  EXPECT_THAT(line, HasSubstr(R"("primitive":70000,"material":"default","position":[1.0,2.0,3.0])"));
  EXPECT_EQ(pickedJson({5, 6}, {}, {}, {}), R"({"event":"picked","x":5,"y":6,"instance":null})");
  Printed printed;
  printed.lines.push_back({{3, 4}, {}, 5, {"a.rchit", 12, 3}, "a.rchit", "t = 1"});
  printed.omitted = 2;
  EXPECT_EQ(eventJson(LinesPrinted{printed}),
            R"({"event":"printed","lines":[{"pixel":[3,4],"sample":5,"stage":"a.rchit","file":"a.rchit","line":12,)"
            R"("text":"t = 1"}],"omitted":2})");
  PixelExplanation explanation;
  explanation.pixel = {3, 4};
  explanation.sample = 5;
  EXPECT_EQ(explainedJson(explanation, "p.json"), R"({"event":"explained","x":3,"y":4,"sample":5,"file":"p.json"})");
  EXPECT_THAT(explainedJson(explanation, ""),
              ::testing::AllOf(HasSubstr(R"("explanation":{"format":)"), ::testing::Not(HasSubstr("\n"))));
  EXPECT_EQ(failedJson(7, "no"), R"({"event":"error","line":7,"message":"no"})");
}

}  // namespace
}  // namespace quintet::job::interactive
