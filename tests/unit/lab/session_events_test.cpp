// SPDX-License-Identifier: Apache-2.0
// The events that need no device, against the schema. tests/lab checks all events that it receives.
#include "lab/session_events.h"

#include <limits>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "job/interactive/command_json.h"
#include "job/interactive/event_json.h"
#include "lab/file_message.h"
#include "lab/image_message.h"
#include "lab/little_endian.h"
#include "lab/page_message.h"

namespace quintet::lab {
namespace {

namespace interactive = job::interactive;
using Json = nlohmann::json;

// Why an event differs from its description.
std::string problemOf(const interactive::MessageSchema& schema, const std::string& event) {
  try {
    schema.checkEvent(Json::parse(event));
  } catch (const UsageError& error) {
    return event + ": " + error.what();
  }
  return "";
}

const std::vector<Diagnostic> kDiagnostics{
    {Severity::error, "a.rgen", 3, 0, "Q101", "text", {{"b.rmiss", 4, 5, "related"}}}};

job::Printed printed() {
  job::Printed lines;
  lines.lines.push_back({{3, 4}, 2, {}, {"a.rgen", 12, 3}, "a.rgen", "t = 1"});
  lines.lines.push_back({{3, 4}, {}, 5, {"a.rgen", 12, 3}, "a.rgen", "t = 1"});
  return lines;
}

interactive::Pick pick() {
  interactive::Pick pick;
  pick.position = {1, 2, 3};
  return pick;
}

TEST(SessionEvents, ConformToTheSchemaOfTheLab) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  job::PixelExplanation explanation;
  for (const std::string& event : {openingJson(3),
                                   diagnosticsJson(kDiagnostics, true),
                                   statisticsJson({.samples = 4, .error = 0.5}),
                                   statisticsJson({.samples = 4, .error = std::numeric_limits<double>::infinity()}),
                                   statisticsJson({}),
                                   imageJson({4, {8, 6}, 2, false}, 7),
                                   valueJson({1, 2}, {0.25f, kInfinity, -kInfinity}),
                                   fileJson(1, "image.exr", "image/x-exr", std::uint64_t{5} << 30),
                                   progressJson(1, 9),
                                   graphJson("{}"),
                                   workerJson("waiting", "message", 2),
                                   messageJson("stage", "text", "text"),
                                   messageJson("warning", "text"),
                                   messageJson("error", "text"),
                                   withId(messageJson("error", "text"), "\"a\""),
                                   withId(R"({"event":"done"})", "7"),
                                   interactive::eventJson(interactive::Restarted{}),
                                   interactive::eventJson(interactive::ProgramReloaded{"a.rgen"}),
                                   interactive::eventJson(interactive::LinesPrinted{printed()}),
                                   interactive::eventJson(interactive::DeviceReplaced{"device", "message"}),
                                   interactive::eventJson(interactive::Note{"text"}),
                                   interactive::eventJson(interactive::Warning{"text"}),
                                   interactive::eventJson(interactive::Failed{"message"}),
                                   interactive::pickedJson({1, 2}, {}, {}, {}),
                                   interactive::pickedJson({1, 2}, pick(), {"a"}, {"b"}),
                                   interactive::explainedJson(explanation, "")})
    EXPECT_EQ(problemOf(labSchema(), event), "");
}

TEST(SessionEvents, ConformToTheSchemaOfScripts) {
  job::PixelExplanation explanation;
  for (const std::string& event :
       {interactive::eventJson(interactive::ImageUpdated{4, {8, 6}, 2, false}),
        interactive::eventJson(interactive::DiagnosticsFound{kDiagnostics}), interactive::savedJson("a.png"),
        interactive::explainedJson(explanation, "a.json"), interactive::failedJson(3, "message"),
        interactive::pickedJson({1, 2}, pick(), {"a"}, {"b"})})
    EXPECT_EQ(problemOf(interactive::scriptSchema(), event), "");
}

TEST(SessionEvents, TheSchemaRejectsOthers) {
  EXPECT_THAT(problemOf(labSchema(), workerJson("ended", "", 0)), testing::HasSubstr("'state' cannot be 'ended'"));
  EXPECT_THAT(problemOf(labSchema(), messageJson("stage", "text")), testing::HasSubstr("unknown key 'message'"));
}

// Reads a field of a header by the layout of the schema.
std::uint64_t fieldOf(const std::string& message, const std::string& kind, const std::string& name) {
  const auto& field = labSchema().content()["binary"][kind]["fields"][name];
  return integerAt(message, field["at"], field["bytes"]);
}

TEST(BinaryMessages, HaveTheLayoutOfTheSchema) {
  const std::string image =
      imageMessage({.number = 1, .size = {2, 3}, .factor = 4, .samples = 5, .complete = true}, {});
  const std::map<std::string, std::uint64_t> imageFields{{"number", 1},  {"width", 2},  {"height", 3},  {"factor", 4},
                                                         {"samples", 5}, {"format", 2}, {"complete", 1}};
  for (const auto& [name, value] : imageFields) EXPECT_EQ(fieldOf(image, "image", name), value) << name;
  const std::string file = fileMessage({.file = 6, .offset = std::uint64_t{7} << 40, .bytes = {}});
  EXPECT_EQ(fieldOf(file, "file", "file"), 6u);
  EXPECT_EQ(fieldOf(file, "file", "offset"), std::uint64_t{7} << 40);
  for (const auto& [kind, message] : {std::pair("image", image), std::pair("file", file)}) {
    const auto& layout = labSchema().content()["binary"][kind];
    EXPECT_EQ(message.substr(0, 4), layout["magic"]);
    EXPECT_EQ(integerAt(message, 4, 4), layout["version"]);
  }
  EXPECT_EQ(labSchema().content()["binary"]["image"]["fields"].size(), imageFields.size());
}

}  // namespace
}  // namespace quintet::lab
