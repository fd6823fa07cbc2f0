// SPDX-License-Identifier: Apache-2.0
// Attacks on a server: by those who can connect to it, by the files of a project, and by shaders (docs/lab.md, "What the token
// grants").
#include <dirent.h>
#include <signal.h>  // NOLINT: kill() of POSIX
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include "base/file.h"
#include "base/stopwatch.h"
#include "lab/sandbox.h"
#include "lab/server.h"
#include "page_client.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
namespace fs = std::filesystem;
namespace asio = boost::asio;
using asio::ip::tcp;

constexpr const char* kPlain = R"(/**** COMMON START ****/
//COMMON
struct RayPayloadType {
  vec3 color;
};
/**** COMMON END ****/
/**** RAY GENERATION SHADER ****/
void main() {
  payload.color = vec3(0.0, 1.0, 0.0);
  //BODY
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 100.0, 0.0), 0.001, vec3(0.0, 1.0, 0.0), 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
/**** CLOSEST-HIT SHADER ****/
void main() {
  payload.color = vec3(0.5);
}
/**** MISS SHADER ****/
void main() {
  payload.color = vec3(1.0);
}
)";

std::string program(const std::string& common, const std::string& body = "") {
  std::string text = kPlain;
  text.replace(text.find("//COMMON"), 8, common);
  return text.replace(text.find("//BODY"), 6, body);
}

std::string nested(std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); }

// "CapEff" → "0000000000000000", in /proc/PID/status.
std::string statusOf(pid_t process, const std::string& name) {
  std::ifstream file("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name + ":")) return line.substr(line.find_first_not_of(" \t", name.size() + 1));
  return {};
}

std::string namespaceOf(const std::string& process, const std::string& kind) {
  std::error_code error;
  return fs::read_symlink("/proc/" + process + "/ns/" + kind, error).string();
}

class LabAttack : public ::testing::Test {
 protected:
  LabAttack() {
    fs::create_directories(folder_ / "project");
    save(kPlain);
  }
  void save(const std::string& text, const std::string& name = "mine.rt.glsl") const {
    fs::create_directories((folder_ / "project" / name).parent_path());
    writeFile(folder_ / "project" / name, text);
  }
  LabProcess start(std::vector<std::string> options = {}) const {
    options.insert(options.end(), {"--size", "16x9", "--spp", "1"});
    return LabProcess(folder_ / "project", options);
  }
  static Json open() { return {{"do", "open"}, {"program", "mine.rt.glsl"}, {"samples", 1}, {"id", 1}}; }
  static std::string messagesOf(const Json& diagnostics) { return diagnostics.at("diagnostics").dump(); }

  const TempFolder folder_;
};

// ---- Messages

TEST_F(LabAttack, DeepMessagesEndTheirSessionOnly) {
  const LabProcess server = start();
  PageClient other(server);
  other.send(open());
  other.waitForImage();
  for (const std::size_t levels : {std::size_t{1000}, std::size_t{200'000}}) {
    PageClient page(server);
    page.sendText(R"({"do":"open","program":"mine.rt.glsl","parameters":{"x":)" + nested(levels) + "}}");
    EXPECT_EQ(page.waitForClose(), 1008u) << levels;
  }
  PageClient large(server);
  try {
    large.sendText(nested(5'000'000));  // above the limit of a message
  } catch (const std::exception&) {     // the server has closed the connection before
  }
  EXPECT_THAT(large.waitForClose(), AnyOf(1009u, 1006u, 0u));
  EXPECT_EQ(server.request("POST", "/api/programs", nested(500'000)).status, 400u);
  other.send({{"do", "value"}, {"x", 1}, {"y", 1}, {"id", 2}});
  other.waitFor("value");
}

TEST_F(LabAttack, DeepFilesAreErrors) {
  save(R"({"asset":{"version":"2.0"},"extras":)" + nested(200'000) + "}", "deep.gltf");
  save("a = " + nested(200'000) + "\n", "scenes/deep.scene.toml");
  save("[program]\nname = " + nested(200'000) + "\n", "folder/program.toml");
  save(program("#if " + std::string(200'000, '(') + "1" + std::string(200'000, ')') + "\n#endif"), "if.rt.glsl");
  const LabProcess server = start();
  PageClient page(server);
  int id = 100;
  const auto opens = [&](const Json& names) {
    Json message = open();
    message.update(names);
    message["id"] = ++id;
    page.send(message);
    return page.waitFor([&](const Json& event) {
      const std::string name = event.value("event", "");
      return (name == "error" || name == "done") && event.contains("id") && event.at("id") == id;
    });
  };
  EXPECT_EQ(opens({{"scene", "deep.gltf"}}).at("event"), "error");
  EXPECT_EQ(opens({{"scene", "scenes/deep.scene.toml"}}).at("event"), "error");
  EXPECT_EQ(opens({{"program", "folder"}}).at("event"), "error");
  opens({{"program", "if.rt.glsl"}});
  const Json plain = opens(Json::object());
  EXPECT_EQ(plain.at("event"), "done") << plain;
  for (const Json& event : page.events()) EXPECT_NE(event.value("state", ""), "crashed") << event;
}

TEST_F(LabAttack, FloodsOfMessagesAreNotQueued) {
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  page.waitForImage();
  ASSERT_EQ(server.workers().size(), 1u);
  ::kill(server.workers().front(), SIGSTOP);
  const std::size_t before = server.memory();
  const std::string message = R"({"do":"pause","on":true,"x":")" + std::string(1'000'000, 'x') + "\"}";
  try {
    for (int i = 0; i < 300; ++i) page.sendText(message);
  } catch (const std::exception&) {  // the server has closed the connection
  }
  EXPECT_EQ(page.waitForClose(), 1008u);
  EXPECT_THAT(page.closeReason(), HasSubstr("more messages than its worker can read"));
  EXPECT_LT(server.memory(), before + (std::size_t{64} << 20));
  for (int i = 0; i < 250 && !server.workers().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(server.workers().empty());
}

// ---- Connections

TEST_F(LabAttack, OpenConnectionsKeepNoBrowserOut) {
  const LabProcess server = start();
  asio::io_context context;
  std::vector<std::unique_ptr<tcp::socket>> idle;
  for (int i = 0; i < 400; ++i) {
    idle.push_back(std::make_unique<tcp::socket>(context));
    idle.back()->connect({asio::ip::make_address("127.0.0.1"), server.port()});
    if (i % 2) asio::write(*idle.back(), asio::buffer(std::string("GET / HTTP/1.1\r\nHost: local")));
  }
  const Stopwatch clock;
  EXPECT_EQ(server.request("GET", "/api/files").status, 200u);
  PageClient page(server);
  EXPECT_TRUE(page.isOpen());
  EXPECT_LT(clock.seconds(), 3.0);
}

TEST_F(LabAttack, IncompleteRequestsEndSoon) {
  const LabProcess server = start();
  asio::io_context context;
  tcp::socket idle(context);
  idle.connect({asio::ip::make_address("127.0.0.1"), server.port()});
  asio::write(idle, asio::buffer(std::string("GET / HTTP/1.1\r\n")));
  const Stopwatch clock;
  char byte = 0;
  boost::system::error_code error;
  idle.read_some(asio::buffer(&byte, 1), error);
  EXPECT_TRUE(error);
  EXPECT_LT(clock.seconds(), 15.0);
}

// ---- Access

TEST_F(LabAttack, ArgumentsOfTheBrowserContainNoToken) {
  fs::create_directories(folder_ / "bin");
  writeFile(folder_ / "bin/xdg-open", "#!/bin/sh\necho \"$1\" > " + (folder_ / "new").string() + "\nmv " +
                                          (folder_ / "new").string() + " " + (folder_ / "url").string() + "\n");
  fs::permissions(folder_ / "bin/xdg-open", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", ((folder_ / "bin").string() + ":" + path).c_str(), 1);
  ::setenv("DISPLAY", ":none", 0);
  const LabProcess server(folder_ / "project", {}, true);
  ::setenv("PATH", path.c_str(), 1);
  for (int i = 0; i < 500 && !fs::exists(folder_ / "url"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const std::string url = readTextFile(folder_ / "url");
  EXPECT_EQ(url.find(server.token()), url.npos) << url;
  ASSERT_NE(url.find("/?ticket="), url.npos) << url;
  const std::string target = url.substr(url.find("/?ticket="), 41);
  const Headers nothing{{"cookie", "x=y"}};
  const Reply login = server.request("GET", target, "", nothing);
  EXPECT_EQ(login.status, 303u) << login.body;
  const std::string cookie = login.headers.at("set-cookie");
  EXPECT_EQ(server.request("GET", "/", "", {{"cookie", cookie.substr(0, cookie.find(';'))}}).status, 200u);
  EXPECT_EQ(server.request("GET", target, "", nothing).status, 403u) << "once";
}

TEST_F(LabAttack, AddressesOfTheNetworkAreAnnounced) {
  const lab::ProjectFolder project(folder_ / "project");
  const auto exposure = [&](const std::string& address) {
    return lab::Server(project, {.address = address, .page = {}}).exposure();
  };
  EXPECT_EQ(exposure("127.0.0.1"), "");
  EXPECT_THAT(exposure("0.0.0.0"), StartsWith("all machines that reach an address of this machine, port "));
  EXPECT_THAT(exposure("0.0.0.0"), HasSubstr("a person who has the URL"));
}

// ---- Files

TEST_F(LabAttack, FilesOfTheProjectAreNoPages) {
  const std::string script = "<svg xmlns='http://www.w3.org/2000/svg'><script>fetch('/api/files')</script></svg>";
  save(script, "a.svg");
  save("<script>fetch('/api/files')</script>", "a.html");
  save("<html xmlns='http://www.w3.org/1999/xhtml'><script/></html>", "a.xhtml");
  const LabProcess server = start();
  for (const char* name : {"a.svg", "a.html", "a.xhtml", "mine.rt.glsl"}) {
    const Reply reply = server.request("GET", std::string("/api/files/") + name);
    EXPECT_EQ(reply.status, 200u);
    EXPECT_EQ(reply.headers.at("content-disposition"), "attachment") << name;
    EXPECT_EQ(reply.headers.at("x-content-type-options"), "nosniff") << name;
    EXPECT_THAT(reply.headers.at("content-security-policy"), HasSubstr("sandbox;")) << name;
    EXPECT_THAT(reply.headers.at("content-security-policy"), Not(HasSubstr("script-src"))) << name;
    EXPECT_THAT(reply.headers.at("content-type"), Not(HasSubstr("html"))) << name;
  }
  EXPECT_THAT(server.request("GET", "/").headers.at("content-security-policy"), HasSubstr("script-src 'self'"));
}

TEST_F(LabAttack, AFileGivesNoAccessToItsFolder) {
  save("vec3 tint() { return vec3(1.0); }\n", "named.glsl");
  save("password\n", "other.glsl");
  save("password\n", "other.txt");
  save(program("#include \"named.glsl\""));
  const LabProcess server(folder_ / "project/mine.rt.glsl", {"--size", "16x9", "--spp", "1"});
  std::vector<std::string> names;
  const Json list = server.request("GET", "/api/files").json();
  for (const Json& file : list.at("files")) names.push_back(file.at("path"));
  EXPECT_THAT(names, ElementsAre("mine.rt.glsl", "named.glsl"));
  for (const char* name : {"other.txt", "other.glsl"}) {
    const Reply read = server.request("GET", std::string("/api/files/") + name);
    EXPECT_EQ(read.status, 400u);
    EXPECT_THAT(read.body, Not(HasSubstr("password")));
    EXPECT_EQ(server.request("PUT", std::string("/api/files/") + name, "x", {{"if-match", "*"}}).status, 400u);
  }
  EXPECT_EQ(readTextFile(folder_ / "project/other.txt"), "password\n");
  PageClient page(server);
  page.send(open());
  page.waitForImage();
  // What the page writes belongs to the project, for a worker that runs already, too.
  EXPECT_EQ(
      server.request("PUT", "/api/files/new.glsl", "vec3 more() { return vec3(0.0); }\n", {{"if-none-match", "*"}})
          .status,
      201u);
  save(program("#include \"new.glsl\""));
  page.send(open());
  EXPECT_EQ(
      page.waitFor([](const Json& e) { return e.value("event", "") == "done" || e.value("event", "") == "error"; })
          .at("event"),
      "done");
  save(program("#include \"other.glsl\""));
  page.send(open());
  const std::string messages = messagesOf(page.waitFor("diagnostics"));
  EXPECT_THAT(messages, HasSubstr("other.glsl"));
  EXPECT_THAT(messages, Not(HasSubstr("password")));
}

TEST_F(LabAttack, MessagesContainNothingOfHiddenFiles) {
  save("password\n", ".ssh/id_key");
  save("password\n", ".env");
  save("[program]\nraygen = \".envv\"\n", "folder/program.toml");
  save("password\n", "folder/.env.rgen");
  const LabProcess server = start();
  EXPECT_THAT(server.request("GET", "/api/files").body, Not(HasSubstr("env")));
  EXPECT_THAT(server.request("GET", "/api/program?name=folder").body, Not(HasSubstr(".env.rgen")));
  PageClient page(server);
  for (const char* include : {".ssh/id_key", ".env", "folder/../.env", "folder/.env.rgen"}) {
    save(program(std::string("#include \"") + include + "\""));
    page.send(open());
    const std::string messages = messagesOf(page.waitFor([](const Json& event) {
      return event.value("event", "") == "diagnostics" && !event.at("diagnostics").empty();
    }));
    EXPECT_THAT(messages, HasSubstr("include")) << include;
    EXPECT_THAT(messages, Not(HasSubstr("password"))) << include;
  }
}

// ---- Workers

TEST_F(LabAttack, WorkersAreContained) {
  const lab::SandboxSupport& support = lab::sandboxSupport();
  const LabProcess server = start({"--max-memory", "3G"});
  PageClient page(server);
  page.send(open());
  page.waitForImage();
  ASSERT_EQ(server.workers().size(), 1u);
  const pid_t worker = server.workers().front();
  EXPECT_EQ(statusOf(worker, "NoNewPrivs"), "1");
  EXPECT_EQ(statusOf(worker, "CapEff"), "0000000000000000");
  EXPECT_EQ(statusOf(worker, "CapPrm"), "0000000000000000");
  if (support.seccomp) {
    EXPECT_EQ(statusOf(worker, "Seccomp"), "2");
  }
  const auto isOwn = [&](const char* kind) {
    return namespaceOf(std::to_string(worker), kind) != namespaceOf("self", kind);
  };
  if (support.namespaces) {
    for (const char* kind : {"user", "pid", "net", "ipc", "mnt"}) EXPECT_TRUE(isOwn(kind)) << kind;
  }
  std::ifstream file("/proc/" + std::to_string(worker) + "/limits");
  const std::string limits{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(limits, ::testing::ContainsRegex("Max core file size +0 "));
  EXPECT_THAT(limits, Not(::testing::ContainsRegex("Max data size +unlimited")));
  EXPECT_THAT(limits, Not(::testing::ContainsRegex("Max file size +unlimited")));
  EXPECT_THAT(limits, Not(::testing::ContainsRegex("Max cpu time +unlimited")));
}

TEST_F(LabAttack, WorkersEndAtTheLimitOfTheirMemory) {
  const LabProcess server = start({"--max-memory", "20M"});
  PageClient page(server);
  page.send(open());
  const Json hung = page.waitForWorker("hung", 60);
  EXPECT_THAT(hung.at("message").get<std::string>(),
              HasSubstr("more than 20.0 MiB of memory, the limit; --max-memory"));
  EXPECT_EQ(server.request("GET", "/api/files").status, 200u);
}

TEST_F(LabAttack, MacroBombsAreErrors) {
  std::string bomb = "#define A0 1.0\n";
  for (int i = 1; i < 34; ++i)
    bomb += "#define A" + std::to_string(i) + " A" + std::to_string(i - 1) + " + A" + std::to_string(i - 1) + "\n";
  save(program(bomb, "payload.color.x = A33;"));
  const LabProcess server = start();
  PageClient page(server);
  page.send(open());
  const std::string messages = messagesOf(page.waitFor(
      [](const Json& event) { return event.value("event", "") == "diagnostics" && !event.at("diagnostics").empty(); }));
  EXPECT_THAT(messages, HasSubstr("the macro 'A33' expands to too much text"));
  std::ifstream statm("/proc/" + std::to_string(server.workers().at(0)) + "/statm");
  std::size_t size = 0, resident = 0;
  statm >> size >> resident;
  EXPECT_LT(resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)), std::size_t{1} << 30);
}

// On a CPU, an address of a shader is one of the process.
TEST_F(LabAttack, ShadersThatUseAnyAddressCrashAtWorst) {
  for (const char* access :
       {"Words(uvec2(64u, 0u)).word = 7u;", "payload.color.x = float(Words(uvec2(4096u, 32767u)).word);",
        "for (uint i = 0u; i < 64u; ++i) Words(uvec2(i << 24, 32000u + i)).word = i;"}) {
    save(
        program("#extension GL_EXT_buffer_reference : require\n#extension GL_EXT_buffer_reference_uvec2 : require\n"
                "layout(buffer_reference, std430, buffer_reference_align = 4) buffer Words { uint word; };",
                access));
    const LabProcess server = start({"--timeout", "20"});
    PageClient page(server);
    page.send(open());
    page.waitFor(
        [](const Json& event) {
          return event.value("event", "") == "done" || event.value("event", "") == "error" ||
                 event.value("event", "") == "worker";
        },
        60);
    EXPECT_EQ(server.request("GET", "/api/files").status, 200u);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    PageClient next(server);
    save(kPlain);
    next.send(open());
    next.waitForImage();
  }
}

}  // namespace
}  // namespace quintet::test
