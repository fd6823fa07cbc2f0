// SPDX-License-Identifier: Apache-2.0
#include "lab/page_message.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "render/tone_map/tone_map.h"

namespace quintet::lab {
namespace {

using Json = nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
namespace interactive = job::interactive;

PageMessage parsed(const std::string& text) {
  const auto result = parsePageMessage(text);
  if (const auto* error = std::get_if<PageMessageError>(&result)) {
    ADD_FAILURE() << text << ": " << error->message;
    return {};
  }
  return std::get<PageMessage>(result);
}

PageMessageError errorOf(const std::string& text) {
  const auto result = parsePageMessage(text);
  const auto* error = std::get_if<PageMessageError>(&result);
  EXPECT_TRUE(error) << text;
  return error ? *error : PageMessageError{};
}

TEST(PageMessage, ReadsOpen) {
  const PageMessage message = parsed(
      R"({"do":"open","id":7,"program":"mine","scene":"a.glb","width":320,"height":200,"samples":9,
          "parameters":{"tint":[1,0.5,0],"on":true,"n":3,"image":"a.png"},"output":"depth","exposure":-1,"tonemap":"aces",
          "frame":2.5,"camera":{"from":[0,1,4],"at":[0,0,0],"fov":30,"aperture":0.1,"focus":2},"seed":5,"number":12})");
  EXPECT_EQ(message.id, "7");
  const auto& open = std::get<OpenSession>(message.command);
  EXPECT_EQ(open.program, "mine");
  EXPECT_EQ(open.scene, "a.glb");
  EXPECT_EQ(open.size, uvec2(320, 200));
  EXPECT_EQ(open.samples, 9u);
  EXPECT_THAT(open.parameters,
              ElementsAre(Pair("image", "a.png"), Pair("n", "3"), Pair("on", "true"), Pair("tint", "1,0.5,0")));
  EXPECT_EQ(open.output, "depth");
  EXPECT_EQ(open.exposure, -1.0);
  EXPECT_EQ(open.toneMap, "aces");
  EXPECT_EQ(open.frame, 2.5f);
  ASSERT_TRUE(open.camera);
  EXPECT_EQ(open.camera->lookFrom, vec3(0, 1, 4));
  EXPECT_EQ(open.camera->verticalFov, 30.0f);
  EXPECT_EQ(open.camera->apertureRadius, 0.1f);
  EXPECT_EQ(open.seed, 5u);
  EXPECT_EQ(open.number, 12u);
}

TEST(PageMessage, OpenNeedsOnlyAProgram) {
  const PageMessage message = parsed(R"({"do":"open","program":"<programs/ao>","camera":null})");
  EXPECT_EQ(message.id, "");
  const auto& open = std::get<OpenSession>(message.command);
  EXPECT_FALSE(open.size || open.samples || open.camera || open.frame);
}

TEST(PageMessage, ReadsCommandsOfTheLab) {
  EXPECT_EQ(std::get<ImageReceived>(parsed(R"({"do":"received","image":3})").command).image, 3u);
  EXPECT_FALSE(std::get<PauseSession>(parsed(R"({"do":"pause","on":false})").command).on);
  EXPECT_EQ(std::get<AdvanceFrames>(parsed(R"({"do":"advance"})").command).count, 1u);
  EXPECT_EQ(std::get<AdvanceFrames>(parsed(R"({"do":"advance"})").command).until, 0u);
  EXPECT_EQ(std::get<AdvanceFrames>(parsed(R"({"do":"advance","until":12})").command).until, 12u);
  EXPECT_EQ(std::get<PickPixel>(parsed(R"({"do":"pick","x":1,"y":2})").command).pixel, uvec2(1, 2));
  EXPECT_EQ(std::get<ExplainSample>(parsed(R"({"do":"explain","x":1,"y":2,"sample":4})").command).sample, 4u);
  EXPECT_TRUE(std::holds_alternative<RestartWorker>(parsed(R"({"do":"restart"})").command));
}

TEST(PageMessage, ReadsRunTimeChecks) {
  EXPECT_TRUE(std::holds_alternative<InstrumentProgram>(parsed(R"({"do":"instrument"})").command));
}

TEST(PageMessage, ReadsCommandsOfSessions) {
  const auto command = std::get<interactive::Command>(parsed(R"({"do":"orbit","dx":30,"id":"a"})").command);
  EXPECT_EQ(std::get<interactive::Orbit>(command).right, 30.0f);
}

TEST(PageMessage, ReportsErrorsWithTheId) {
  EXPECT_EQ(errorOf(R"({"do":"pick","x":1,"id":"p1"})").id, "\"p1\"");
  EXPECT_THAT(errorOf(R"({"do":"pick","x":1})").message, HasSubstr("'y' is missing"));
  EXPECT_THAT(errorOf(R"({"do":"orbitt"})").message, HasSubstr("unknown command 'orbitt' (did you mean 'orbit'?)"));
  EXPECT_THAT(errorOf(R"({"do":"opne"})").message, HasSubstr("did you mean 'open'?"));
  EXPECT_THAT(errorOf(R"({"do":"open","program":"a","camra":{}})").message, HasSubstr("unknown key 'camra'"));
  EXPECT_THAT(errorOf(R"({"do":"open","program":"a","parameters":{"x":{}}})").message,
              HasSubstr("'x' of 'parameters' must be a number, true or false, a text, or a list of numbers"));
  EXPECT_THAT(errorOf(R"({"do":"open","program":"a","width":8})").message,
              HasSubstr("'width' and 'height' require each other"));
  for (const char* text :
       {R"({"do":"open","program":"a","width":5000,"height":5})", R"({"do":"size","width":5000,"height":5})"})
    EXPECT_EQ(errorOf(text).message, "'width' must be a whole number from 1 to 4096");
  EXPECT_EQ(errorOf(R"({"do":"open","program":"a","camera":{"at":[0,0,0]}})").message, "'from' of 'camera' is missing");
  EXPECT_EQ(errorOf(R"({"do":"open","program":"a","camera":{"from":[0,0,0],"fob":4}})").message,
            "unknown key 'fob' of 'camera' (did you mean 'fov'?)");
  EXPECT_EQ(errorOf(R"({"do":"open"})").message, "'program' is missing");
  EXPECT_THAT(errorOf(R"({"do":"pause","id":[1]})").message, HasSubstr("'id'"));
}

TEST(PageMessage, RejectsWhatIsNoObject) {
  for (const char* text : {"", "[]", "1", "{", "\"do\"", "{\"do\":1e999}", "{'do':'open'}", "{\"do\":\"open\"} x"}) {
    errorOf(text);
    EXPECT_FALSE(commandName(text) == "open") << text;
  }
  errorOf(std::string(100000, '['));
  errorOf("{\"do\":\"open\",\"program\":\"\xFF\"}");
}

// Copying and printing such a value would overflow the stack: of the server, too, which reads the name of the command.
TEST(PageMessage, RejectsDeepMessages) {
  for (const std::size_t levels : {std::size_t{1000}, std::size_t{200'000}}) {
    const std::string value = std::string(levels, '[') + std::string(levels, ']');
    const std::string message = R"({"do":"open","program":"a","parameters":{"x":)" + value + "}}";
    EXPECT_FALSE(commandName(message));
    EXPECT_EQ(errorOf(message).message, "the message is no JSON object");
  }
}

TEST(PageMessage, ReadsValuesOfBlocks) {
  const auto one = std::get<ReadValue>(parsed(R"({"do":"value","x":3,"y":4})").command);
  EXPECT_EQ(one.pixel, uvec2(3, 4));
  EXPECT_EQ(one.size, uvec2(1));
  EXPECT_EQ(std::get<ReadValue>(parsed(R"({"do":"value","x":3,"y":4,"width":5,"height":6})").command).size,
            uvec2(5, 6));
  EXPECT_EQ(std::get<ReadValue>(parsed(R"({"do":"value","x":3,"y":4,"width":5})").command).size, uvec2(5, 1));
  EXPECT_THAT(errorOf(R"({"do":"value","x":3,"y":4,"width":0,"height":6})").message, HasSubstr("width"));
}

TEST(PageMessage, ReadsVideosAndFiles) {
  const auto video = std::get<RenderVideo>(parsed(R"({"do":"video","frames":48})").command);
  EXPECT_EQ(video.frames, 48u);
  EXPECT_EQ(video.framesPerSecond, 24.0);
  EXPECT_EQ(video.format, "mp4");
  EXPECT_FALSE(video.turn);
  const auto gif =
      std::get<RenderVideo>(parsed(R"({"do":"video","frames":2,"fps":12.5,"format":"gif","turn":true})").command);
  EXPECT_EQ(gif.framesPerSecond, 12.5);
  EXPECT_EQ(gif.format, "gif");
  EXPECT_TRUE(gif.turn);
  EXPECT_THAT(errorOf(R"({"do":"video","frames":0})").message, HasSubstr("frames"));
  EXPECT_THAT(errorOf(R"({"do":"video","frames":10001})").message, HasSubstr("10000"));
  EXPECT_EQ(errorOf(R"({"do":"video","frames":1,"fps":0})").message,
            "'fps' must be a number above 0 and of at most 240");
  EXPECT_THAT(errorOf(R"({"do":"video","frames":1,"format":"avi"})").message, HasSubstr("mp4, webm, gif"));
  const auto part = std::get<ReadFilePart>(parsed(R"({"do":"read","file":2,"offset":5000000000})").command);
  EXPECT_EQ(part.file, 2u);
  EXPECT_EQ(part.offset, 5000000000u);
  EXPECT_THAT(errorOf(R"({"do":"read","file":2,"offset":0.5})").message, HasSubstr("offset"));
  EXPECT_THAT(errorOf(R"({"do":"read","file":2,"offset":-1})").message, HasSubstr("offset"));
}

TEST(PageMessage, ReadsProgramsThatAreNotSaved) {
  // A restarted worker gets the last `open` with the empty name of its program.
  const auto open = std::get<OpenSession>(parsed(R"({"do":"open","program":"","files":{"a.rt.glsl":"text"}})").command);
  EXPECT_EQ(open.program, "");
  EXPECT_THAT(open.files, ElementsAre(Pair("a.rt.glsl", "text")));
  EXPECT_THAT(errorOf(R"({"do":"open","files":{}})").message, HasSubstr("'files'"));
  EXPECT_EQ(errorOf(R"({"do":"open","files":{"a.rt.glsl":1}})").message, "'a.rt.glsl' of 'files' must be a text");
}

// A value of a type of the schema.
Json sample(const std::string& type) {
  const Json types = labSchema().content()["types"];
  if (type.ends_with("{}")) return {{"a.rt.glsl", sample(type.substr(0, type.size() - 2))}};
  if (const std::size_t list = type.find('['); list != type.npos) {
    const std::string size = type.substr(list + 1, type.size() - list - 2);
    return Json(size.empty() ? 1 : std::stoul(size), sample(type.substr(0, list)));
  }
  if (const std::size_t end = type.find('|'); end != type.npos) return sample(type.substr(0, end));
  if (!types.contains(type)) return type == "text" ? Json("a") : type == "flag" ? Json(true) : Json(2);
  const Json& described = types[type];
  if (described.contains("is")) return sample(described["is"]);
  if (described.contains("values")) return described["values"][0];
  Json object = Json::object();
  for (const auto& [name, field] : described.at("fields").items()) object[name] = sample(field["type"]);
  return object;
}

TEST(PageMessage, ReadsEveryCommandOfTheSchema) {
  for (const auto& [name, command] : labSchema().content()["commands"].items()) {
    Json message{{"do", name}};
    if (command.contains("fields"))
      for (const auto& [field, description] : command["fields"].items()) message[field] = sample(description["type"]);
    if (command.contains("others")) message["property"] = sample(command["others"]);
    const PageCommand parsedCommand = parsed(message.dump()).command;
    EXPECT_EQ(std::holds_alternative<OpenSession>(parsedCommand), name == "open") << name;
  }
}

TEST(PageMessage, TheSchemaHasTheToneMaps) {
  std::vector<std::string> names = render::toneMapNames();
  names.insert(names.begin(), "default");
  EXPECT_EQ(labSchema().content()["types"]["ToneMap"]["values"].get<std::vector<std::string>>(), names);
}

}  // namespace
}  // namespace quintet::lab
