// SPDX-License-Identifier: Apache-2.0
// Seeds for the lab: messages of a page, targets of requests, and zip files.
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "lab/zip.h"
#include "seeds.h"

namespace quintet::fuzz {
namespace {

constexpr std::string_view kMessages[] = {
    R"({"do":"open","id":1,"program":"mine","scene":"a.glb","width":64,"height":32,"samples":9,"output":"image","exposure":1,)"
    R"("parameters":{"tint":[1,0.5,0],"on":true,"n":3,"name":"a.png"},"tonemap":"aces","frame":2.5,"seed":5,)"
    R"("camera":{"from":[0,1,4],"at":[0,0,0],"up":[0,1,0],"fov":30,"aperture":0.1,"focus":2}})",
    R"({"do":"received","image":3})",
    R"({"do":"pause","on":false,"id":"a"})",
    R"({"do":"advance","frames":2})",
    R"({"do":"pick","x":1,"y":2,"id":7})",
    R"({"do":"explain","x":1,"y":2,"sample":3})",
    R"({"do":"orbit","dx":30,"dy":-1.5})",
    R"({"do":"set","parameter":"tint","value":[1,2,3]})",
    R"({"do":"material","name":"Gold","roughness":0.2,"baseColor":[1,1,1,1]})",
    R"({"do":"transform","instance":"a","matrix":[1,0,0,0,0,1,0,0,0,0,1,0]})",
    R"({"do":"print","x":1,"y":2,"width":3,"height":4,"limit":5})",
    "/api/files/a%20b?name=%3Cprograms%2Fao%3E&to=x+y&flag",
};

Seed seedOf(const std::string& name, std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {name, {bytes.begin(), bytes.end()}};
}

}  // namespace

void addLabSeeds(Corpora& corpora) {
  for (const std::string_view message : kMessages)
    corpora["lab_message"].push_back(seedOf(fmt::format("{:02}", corpora["lab_message"].size()), message));
  corpora["lab_zip"] = {
      seedOf("empty.zip", lab::zipFiles({})),
      seedOf("program.zip",
             lab::zipFiles({{"mine/program.toml", "[program]\n"}, {"mine/a.rgen", std::string(300, 'x')}})),
  };
}

}  // namespace quintet::fuzz
