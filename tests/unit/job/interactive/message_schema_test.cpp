// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/message_schema.h"

#include <gmock/gmock.h>

#include "base/error.h"

namespace quintet::job::interactive {
namespace {

using nlohmann::json;

const char* const kFirst = R"({
  "types": {
    "Level": {"values": ["low", "high"]},
    "Any": {"is": "number|Level|null"},
    "Item": {"fields": {"name": "text", "size": {"type": "count", "default": 3}}},
    "Opaque": {"module": "./opaque"}
  },
  "common": {"id": "text?"},
  "commands": {
    "one": {"fields": {"a": "index", "b": {"type": "flag", "default": true}, "c": "Any?"}},
    "two": {"fields": {"items": "Item[]", "pair": "Level[2]?", "map": "number{}?", "opaque": "Opaque?"}},
    "free": {"fields": {"name": "text"}, "others": "number", "atLeastOne": true},
    "pair": {"fields": {"x": "number?", "y": "number?"}, "together": ["x", "y"]}
  },
  "events": {"end": {}}
})";
const char* const kSecond = R"({
  "commands": {"one": {"fields": {"a": {"type": "number", "max": 2}}}},
  "events": {"begin": {"fields": {"count": "whole"}}}
})";

json readFirst(const std::string& text) { return MessageSchema({kFirst}).readCommand(text); }

std::string problemOf(const std::string& text) {
  try {
    readFirst(text);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MessageSchema, AddsDefaults) {
  EXPECT_EQ(readFirst(R"({"do":"one","a":4,"id":"x"})"), json({{"do", "one"}, {"a", 4}, {"b", true}, {"id", "x"}}));
  EXPECT_EQ(readFirst(R"({"do":"two","items":[{"name":"n"}]})")["items"][0]["size"], 3);
}

TEST(MessageSchema, NamesWhatIsWrong) {
  EXPECT_EQ(problemOf(R"({"do":"one"})"), "'a' is missing");
  EXPECT_EQ(problemOf(R"({"do":"one","a":-1})"), "'a' must be a whole number from 0 to 16777216");
  EXPECT_EQ(problemOf(R"({"do":"one","a":0.5})"), "'a' must be a whole number from 0 to 16777216");
  EXPECT_EQ(problemOf(R"({"do":"one","a":1,"c":true})"), "'c' must be a number, a text, or null");
  EXPECT_EQ(problemOf(R"({"do":"one","a":1,"c":"lwo"})"), "'c' cannot be 'lwo' (did you mean 'low'?)");
  EXPECT_EQ(problemOf(R"({"do":"one","a":1,"c":null})"), "no error");
  EXPECT_EQ(problemOf(R"({"do":"one","a":1,"id":3})"), "'id' must be a text");
  EXPECT_EQ(problemOf(R"({"do":"two","items":{}})"), "'items' must be a list");
  EXPECT_EQ(problemOf(R"({"do":"two","items":[{"name":"n"},{"nmae":"n"}]})"),
            "unknown key 'nmae' of element 2 of 'items' (did you mean 'name'?)");
  EXPECT_EQ(problemOf(R"({"do":"two","items":[],"pair":["low"]})"), "'pair' must be a list");
  EXPECT_EQ(problemOf(R"({"do":"two","items":[],"pair":["low","mid"]})"),
            "element 2 of 'pair' cannot be 'mid'; available: low, high");
  EXPECT_EQ(problemOf(R"({"do":"two","items":[],"map":{"k":"v"}})"), "'k' of 'map' must be a number");
  EXPECT_EQ(problemOf(R"({"do":"two","items":[],"opaque":{"any":1}})"), "no error");
  EXPECT_EQ(problemOf(R"({"do":"two","items":[],"opaque":1})"), "'opaque' must be an object");
  EXPECT_EQ(problemOf(R"({"do":"free","name":"n"})"), "no value of the free is given");
  EXPECT_EQ(problemOf(R"({"do":"free","name":"n","z":true})"), "'z' must be a number");
  EXPECT_EQ(problemOf(R"({"do":"pair","y":1})"), "'x' and 'y' require each other");
  EXPECT_EQ(problemOf(R"({"do":3})"), "'do' must be a text");
  EXPECT_EQ(problemOf(R"({"do":"tow"})"), "unknown command 'tow' (did you mean 'two'?)");
}

TEST(MessageSchema, LaterFilesReplaceMessages) {
  const MessageSchema schema({kFirst, kSecond});
  EXPECT_EQ(schema.readCommand(R"({"do":"one","a":1.5})")["a"], 1.5);
  EXPECT_THROW(schema.readCommand(R"({"do":"one","a":3})"), UsageError);
  EXPECT_NO_THROW(schema.checkEvent({{"event", "end"}, {"id", "a"}}));
  EXPECT_NO_THROW(schema.checkEvent({{"event", "begin"}, {"count", 5'000'000'000}}));
  EXPECT_THROW(schema.checkEvent({{"event", "begin"}}), UsageError);
  EXPECT_THROW(schema.checkEvent({{"event", "other"}}), UsageError);
}

}  // namespace
}  // namespace quintet::job::interactive
