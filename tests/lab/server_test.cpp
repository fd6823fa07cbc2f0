// SPDX-License-Identifier: Apache-2.0
// The HTTP side of the lab as a process: who gets in, and what files they reach.
#include <signal.h>  // NOLINT: kill() of POSIX
#include <stdlib.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "base/file.h"
#include "lab/api.h"
#include "lab/project_folder.h"
#include "lab/source_format.h"
#include "lab/zip.h"
#include "page_client.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

class LabServer : public ::testing::Test {
 protected:
  LabServer() {
    fs::create_directories(folder_ / "project/mine");
    writeFile(folder_ / "secret.txt", "secret");
    writeFile(folder_ / "project/mine/program.toml", "[program]\nbroken\n");
    server_.emplace(folder_ / "project");
  }
  Reply get(const std::string& target, const Headers& headers = {}) const {
    return server_->request("GET", target, "", headers);
  }

  const TempFolder folder_;
  std::optional<LabProcess> server_;
};

TEST_F(LabServer, ServesThePageOnlyWithTheToken) {
  const Headers nothing{{"cookie", "x=y"}};
  EXPECT_EQ(get("/", nothing).status, 403u);
  EXPECT_EQ(get("/?token=wrong", nothing).status, 403u);
  const Reply login = get("/?token=" + server_->token(), nothing);
  EXPECT_EQ(login.status, 303u);
  EXPECT_EQ(login.headers.at("location"), "/");
  const std::string cookie = login.headers.at("set-cookie");
  EXPECT_THAT(cookie, HasSubstr("HttpOnly; SameSite=Strict"));
  const Reply page = get("/", {{"cookie", cookie.substr(0, cookie.find(';'))}});
  EXPECT_EQ(page.status, 200u);
  EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("<html"));
  EXPECT_THAT(page.headers.at("content-security-policy"), HasSubstr("default-src 'none'; script-src 'self'"));
  EXPECT_EQ(page.headers.at("x-content-type-options"), "nosniff");
  EXPECT_NE(page.headers.at("content-security-policy"), get("/").headers.at("content-security-policy"));  // the nonce
}

TEST_F(LabServer, RejectsOtherSitesAndHosts) {
  EXPECT_EQ(get("/api/files", {{"host", "evil.example"}}).status, 421u);
  EXPECT_EQ(get("/api/files", {{"origin", "http://evil.example"}}).status, 403u);
  EXPECT_EQ(get("/api/files", {{"sec-fetch-site", "cross-site"}}).status, 403u);
  const auto upgrade = [&](Headers headers) {
    EXPECT_FALSE(PageClient(*server_, headers).isOpen());
    headers.insert({{"connection", "upgrade"},
                    {"upgrade", "websocket"},
                    {"sec-websocket-version", "13"},
                    {"sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="}});
    return get("/ws", headers).status;
  };
  EXPECT_EQ(upgrade({{"origin", "http://evil.example"}}), 403u);
  EXPECT_EQ(upgrade({{"authorization", "Bearer wrong"}}), 403u);
  EXPECT_EQ(upgrade({{"host", "evil.example"}}), 421u);
  EXPECT_TRUE(server_->workers().empty());
}

TEST_F(LabServer, ReachesNoFileOutsideOfTheProject) {
  fs::create_symlink(folder_ / "secret.txt", folder_ / "project/link.txt");
  fs::create_directory_symlink(folder_.path(), folder_ / "project/up");
  for (const char* name : {"../secret.txt", "%2e%2e/secret.txt", "..%2fsecret.txt", "%2e%2e%2fsecret.txt",
                           "mine/../../secret.txt", "/etc/passwd", "%2fetc%2fpasswd", "..%5csecret.txt", "link.txt",
                           "up/secret.txt", "mine/%2e%2e/%2e%2e/secret.txt", "%c0%ae%c0%ae/secret.txt",
                           "..%00/secret.txt", ".", "..", "", "~/x", ".ssh/id"}) {
    const Reply read = get(std::string("/api/files/") + name);
    EXPECT_TRUE(read.status == 400u || read.status == 404u) << name << ": " << read.status;
    EXPECT_THAT(read.body, ::testing::Not(HasSubstr("secret\n"))) << name;
    const Reply write = server_->request("PUT", std::string("/api/files/") + name, "x", {{"if-match", "*"}});
    if (std::string(name) != "~/x") {
      EXPECT_EQ(write.status, 400u) << name;
    }
  }
  EXPECT_EQ(readTextFile(folder_ / "secret.txt"), "secret");
  const Reply program = get("/api/program?name=..%2F");
  EXPECT_EQ(program.status, 400u);
  for (const char* to : {"../x", "/x", "up/x", ".x"})
    EXPECT_EQ(server_->request("POST", "/api/programs", Json{{"from", "<programs/ao>"}, {"to", to}}.dump()).status,
              400u)
        << to;
  EXPECT_FALSE(fs::exists(folder_ / "x"));
}

TEST_F(LabServer, WritesFilesWithTheirVersion) {
  const auto put = [&](const std::string& body, const Headers& headers) {
    return server_->request("PUT", "/api/files/a%20b/c.glsl", body, headers);
  };
  EXPECT_EQ(put("one", {}).status, 428u);
  const Reply created = put("one", {{"if-none-match", "*"}});
  EXPECT_EQ(created.status, 201u);
  EXPECT_EQ(created.json().at("hash"), lab::contentHash("one"));
  EXPECT_EQ(put("two", {{"if-none-match", "*"}}).status, 412u);
  const Reply read = get("/api/files/a%20b/c.glsl");
  EXPECT_EQ(read.body, "one");
  EXPECT_EQ(read.headers.at("content-type"), "text/plain; charset=utf-8");
  const std::string etag = read.headers.at("etag");
  EXPECT_EQ(put("two", {{"if-match", etag}}).status, 200u);
  const Reply conflict = put("three", {{"if-match", etag}});
  EXPECT_EQ(conflict.status, 412u);
  EXPECT_EQ(conflict.json().at("hash"), lab::contentHash("two"));
  EXPECT_EQ(readTextFile(folder_ / "project/a b/c.glsl"), "two");
  EXPECT_EQ(server_->request("DELETE", "/api/files/a%20b/c.glsl", "", {{"if-match", "*"}}).status, 200u);
  EXPECT_EQ(get("/api/files/a%20b/c.glsl").status, 404u);
}

TEST_F(LabServer, LimitsRequests) {
  EXPECT_EQ(get("/api/files", {{"x-long", std::string(20000, 'x')}}).status, 431u);
  EXPECT_EQ(server_->request("POST", "/api/programs", std::string((1u << 20) + 1, ' ')).status, 413u);
  // The size is checked before the body arrives.
  EXPECT_EQ(
      server_->request("PUT", "/api/files/a.glb", "x", {{"content-length", "1000000000000"}, {"if-match", "*"}}).status,
      413u);
  EXPECT_EQ(server_->request("PATCH", "/api/files/a.glb", "x").status, 405u);
  EXPECT_EQ(server_->request("POST", "/api/project", "{}").status, 405u);
  EXPECT_EQ(server_->request("POST", "/", "").status, 405u);
  EXPECT_EQ(server_->request("POST", "/api/programs", "{").status, 400u);
  EXPECT_EQ(get("/api/nothing").status, 404u);
  EXPECT_EQ(get("/missing.js").status, 404u);
  EXPECT_EQ(get("/api/files").status, 200u);  // it still works
}

// A page beyond the limit is closed with "try again later" (1013). A page that closes makes room for another one.
TEST_F(LabServer, ClosesPagesBeyondItsSessions) {
  const LabProcess server(folder_ / "project", {"--sessions", "1"});
  PageClient first(server);
  first.waitFor("worker");
  EXPECT_EQ(PageClient(server).waitForClose(), 1013u);
  first.close();
  unsigned refused = 0;
  for (; refused < 100; ++refused) {  // until the server has noticed the end of the first page
    PageClient next(server);
    try {
      next.waitFor("worker");
      break;
    } catch (const std::runtime_error&) {
      EXPECT_EQ(next.waitForClose(), 1013u);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  EXPECT_LT(refused, 100u);
}

TEST_F(LabServer, DescribesProgramsAndLessons) {
  const Json programs = get("/api/programs").json();
  EXPECT_THAT(programs.at("builtIn").dump(), HasSubstr("<programs/lessons/05_shadow>"));
  EXPECT_EQ(programs.at("project").at(0).at("name"), "mine");
  const Json broken = get("/api/program?name=mine").json();
  EXPECT_EQ(broken.at("main"), "mine/program.toml");
  ASSERT_EQ(broken.at("diagnostics").size(), 1u) << broken;
  EXPECT_EQ(broken.at("diagnostics").at(0).at("file"), "mine/program.toml");
  EXPECT_EQ(broken.at("diagnostics").at(0).at("line"), 2);
  const Json shadow = get("/api/program?name=%3Cprograms%2Flessons%2F05_shadow%3E").json();
  EXPECT_EQ(shadow.at("form"), "lecture");
  EXPECT_EQ(shadow.at("files").at(0).at("path"), "<programs/lessons/05_shadow>/shadow.rt.glsl");
  EXPECT_EQ(shadow.at("files").at(0).at("role"), "lecture");
  EXPECT_EQ(shadow.at("scene"), "<programs/lessons/05_shadow>/shadow.scene.toml");
  const Json ao = get("/api/program?name=%3Cprograms%2Fao%3E").json();
  std::map<std::string, std::string> roles;
  for (const Json& file : ao.at("files")) roles[file.at("path")] = file.at("role");
  EXPECT_EQ(roles.at("<programs/ao>/program.toml"), "description");
  EXPECT_EQ(roles.at("<programs/ao>/ao.rgen"), "raygen");
  EXPECT_EQ(get("/api/program?name=%3Cprograms%2Fnothing%3E").status, 404u);
  EXPECT_EQ(get("/api/program?name=nothing").status, 404u);

  const Json lessons = get("/api/lessons").json();
  EXPECT_EQ(lessons.size(), 28u);
  EXPECT_EQ(lessons.at(0).at("name"), "00_pipeline");
  EXPECT_EQ(lessons.at(0).at("program"), "<programs/lessons/01_first_ray>");  // it has none of its own
  const auto positionOf = [&](const std::string& number) {
    std::size_t i = 0;
    while (i < lessons.size() && lessons[i].at("number") != number) ++i;
    return i;
  };
  EXPECT_LT(positionOf("14"), positionOf("06")) << "the order of lessons/README.md";
  for (const Json& lesson : lessons) {
    EXPECT_THAT(get("/api/docs/" + lesson.at("page").get<std::string>()).body, StartsWith("# Lesson")) << lesson;
    EXPECT_THAT(get("/api/docs/" + lesson.at("image").get<std::string>()).headers.at("content-type"),
                StartsWith("image/"))
        << lesson;
    EXPECT_THAT(programs.at("builtIn").dump(), HasSubstr(lesson.at("program").get<std::string>()));
    EXPECT_EQ(lesson.at("copied"), false);
  }
  EXPECT_THAT(get("/api/docs/diagnostics/Q101.md").body, HasSubstr("Q101"));
  EXPECT_EQ(get("/api/docs/design/structure.md").status, 404u);
}

TEST_F(LabServer, FormatsSources) {
  const std::string text = "void main(){ /**** MISS SHADER ****/\nfloat a=1.0;if(a>0.0)payload.color=vec3(a);}\n";
  const Reply reply = server_->request("POST", "/api/format", text);
  if (lab::findFormatter().empty()) {
    EXPECT_EQ(reply.status, 501u);
    return;
  }
  EXPECT_EQ(reply.status, 200u) << reply.body;
  EXPECT_EQ(reply.json().at("text"),
            "void main() { /**** MISS SHADER ****/\n  float a = 1.0;\n  if (a > 0.0) payload.color = vec3(a);\n}\n");
  EXPECT_THAT(reply.json().at("formatter").get<std::string>(), StartsWith("clang-format"));
  EXPECT_EQ(get("/api/format").status, 405u);
}

// A script stands for clang-format: it waits until the test lets it continue.
TEST(LabFormat, DoesNotKeepOthersWaiting) {
  const TempFolder folder;
  fs::create_directories(folder / "bin");
  fs::create_directories(folder / "project");
  const std::string path = std::getenv("PATH");
  const auto writeFormatter = [&](const std::string& script) {
    writeFile(folder / "bin/clang-format", "#!/bin/sh\n" + script);
    fs::permissions(folder / "bin/clang-format", fs::perms::owner_all);
  };
  writeFormatter("echo $$ > " + (folder / "started.").string() + "$$\nwhile [ ! -e " + (folder / "go").string() +
                 " ]; do sleep 0.01; done\ntr ' ' '\\n'\n");
  ::setenv("PATH", ((folder / "bin").string() + ":" + path).c_str(), 1);
  std::optional<LabProcess> server(std::in_place, folder / "project");
  ::setenv("PATH", path.c_str(), 1);
  const auto format = [&] { return server->request("POST", "/api/format", "a b"); };
  const auto started = [&] {
    std::vector<pid_t> processes;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
      if (const std::string name = entry.path().filename(); name.starts_with("started."))
        processes.push_back(std::stoi(name.substr(name.find('.') + 1)));
    return processes;
  };
  const auto awaitStarted = [&](std::size_t count) {
    for (int i = 0; i < 1000 && started().size() < count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_EQ(started().size(), count);
  };

  std::vector<std::future<Reply>> replies;
  for (int i = 0; i < lab::kMaxFormatters; ++i) replies.push_back(std::async(std::launch::async, format));
  awaitStarted(lab::kMaxFormatters);
  EXPECT_EQ(server->request("GET", "/api/project").status, 200u) << "while the formatters run";
  EXPECT_EQ(format().status, 503u);
  writeFile(folder / "go", "");
  for (std::future<Reply>& reply : replies) {
    const Reply formatted = reply.get();
    EXPECT_EQ(formatted.status, 200u) << formatted.body;
    EXPECT_EQ(formatted.json().at("text"), "a\nb");
  }

  writeFormatter("echo other text\n");
  EXPECT_THAT(format().body, HasSubstr("clang-format would change more than white space"));
  writeFormatter("exit 1\n");
  EXPECT_EQ(format().status, 500u);
  EXPECT_THAT(format().body, HasSubstr("clang-format failed"));

  // A formatter ends with the server.
  for (const pid_t process : started()) fs::remove(folder / ("started." + std::to_string(process)));
  writeFormatter("echo > " + (folder / "started.").string() + "$$\nexec sleep 60\n");
  const auto last = std::async(std::launch::async, [&] {
    try {
      format();
    } catch (const std::exception&) {  // the server ends without an answer
    }
  });
  awaitStarted(1);
  const pid_t process = started().front();
  EXPECT_EQ(::kill(process, 0), 0);
  EXPECT_EQ(server->stop(), 0);
  for (int i = 0; i < 200 && ::kill(process, 0) == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_NE(::kill(process, 0), 0);
}

TEST_F(LabServer, CopiesExportsAndImportsPrograms) {
  const Json copy{{"from", "<programs/lessons/05_shadow>"}, {"to", "lessons/05_shadow"}};
  const Reply created = server_->request("POST", "/api/programs", copy.dump());
  EXPECT_EQ(created.status, 201u);
  EXPECT_THAT(created.json().at("files"),
              ElementsAre("lessons/05_shadow/shadow.rt.glsl", "lessons/05_shadow/shadow.scene.toml"));
  const fs::path file = folder_ / "project/lessons/05_shadow/shadow.rt.glsl";
  const std::string original = readTextFile(file);
  EXPECT_EQ(get("/api/program?name=lessons%2F05_shadow").json().at("main"), "lessons/05_shadow/shadow.rt.glsl");
  EXPECT_EQ(server_->request("POST", "/api/programs", copy.dump()).status, 201u);  // nothing differs
  writeFile(file, "changed");
  const Reply conflict = server_->request("POST", "/api/programs", copy.dump());
  EXPECT_EQ(conflict.status, 409u);
  EXPECT_THAT(conflict.json().at("files"), ElementsAre("lessons/05_shadow/shadow.rt.glsl"));
  Json reset = copy;
  reset["replace"] = true;
  EXPECT_EQ(server_->request("POST", "/api/programs", reset.dump()).status, 201u);
  EXPECT_EQ(readTextFile(file), original);

  const Reply lecture = get("/api/export?name=lessons%2F05_shadow&form=lecture");
  EXPECT_EQ(lecture.body, original);
  EXPECT_EQ(lecture.headers.at("content-disposition"), "attachment; filename=\"shadow.rt.glsl\"");
  const Reply folder = get("/api/export?name=%3Cprograms%2Flessons%2F17_records%3E&form=lecture");
  EXPECT_EQ(folder.status, 409u);
  EXPECT_THAT(folder.body, HasSubstr("ray types"));
  EXPECT_THAT(folder.body, HasSubstr("its shader records have the fields"));
  EXPECT_THAT(folder.body, HasSubstr("export it as a zip file"));
  const Reply zip = get("/api/export?name=lessons%2F05_shadow&form=zip");
  EXPECT_EQ(lab::unzipFiles(zip.body).at("05_shadow/shadow.rt.glsl"), original);
  EXPECT_EQ(server_->request("POST", "/api/import?to=again", zip.body, {{"content-type", "application/zip"}}).status,
            201u);
  EXPECT_EQ(readTextFile(folder_ / "project/again/shadow.rt.glsl"), original);
  EXPECT_EQ(server_->request("POST", "/api/import?to=pasted", original, {{"content-type", "text/plain"}}).status, 201u);
  EXPECT_EQ(readTextFile(folder_ / "project/pasted/pasted.rt.glsl"), original);
  const std::string evil = lab::zipFiles({{"a/../../x", "evil"}, {"a/y", ""}});
  EXPECT_EQ(server_->request("POST", "/api/import?to=evil", evil, {{"content-type", "application/zip"}}).status, 400u);
  EXPECT_EQ(server_->request("POST", "/api/import?to=evil", "no zip", {{"content-type", "application/zip"}}).status,
            400u);
  EXPECT_FALSE(fs::exists(folder_ / "x"));
}

}  // namespace
}  // namespace quintet::test
