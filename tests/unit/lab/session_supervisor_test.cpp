// SPDX-License-Identifier: Apache-2.0
#include "lab/session_supervisor.h"

#include <csignal>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace quintet::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

constexpr const char* kOpen = R"({"do":"open","program":"mine","id":1,"parameters":{"n":1},"samples":4})";
constexpr const char* kState =
    R"({"event":"state","program":"mine","parameters":{"n":2},"width":64,"height":32,"samples":8,"frames":false,)"
    R"("output":"color","exposure":1,"tonemap":"aces","frame":0,"camera":{"from":[1,2,3]}})";

class SessionSupervisorTest : public ::testing::Test {
 protected:
  // A page that has opened a program, whose worker has sent its state.
  void open() {
    EXPECT_TRUE(supervisor_.connected(0).start);
    const auto actions = supervisor_.pageSent(1, kOpen);
    EXPECT_FALSE(actions.start);
    EXPECT_THAT(actions.toWorker, ElementsAre(kOpen));
    supervisor_.workerSent(2, kState);
  }
  static Json only(const std::vector<std::string>& messages) {
    EXPECT_EQ(messages.size(), 1u);
    return messages.empty() ? Json() : Json::parse(messages.front());
  }
  static std::vector<std::string> states(const SessionSupervisor::Actions& actions) {
    std::vector<std::string> states;
    for (const std::string& message : actions.toPage) states.push_back(Json::parse(message).at("state"));
    return states;
  }

  SessionSupervisor supervisor_{{.timeout = 2, .idleSeconds = 100}};
};

TEST_F(SessionSupervisorTest, StartsAWorkerForThePage) {
  const auto actions = supervisor_.connected(0);
  EXPECT_TRUE(actions.start);
  EXPECT_FALSE(actions.hold);
  EXPECT_THAT(states(actions), ElementsAre("started"));
  EXPECT_THAT(actions.toWorker, IsEmpty());
}

TEST_F(SessionSupervisorTest, EndsAWorkerThatNeedsTooMuchMemory) {
  open();
  const auto actions = supervisor_.workerExceeded(std::uint64_t{1} << 30, "; --max-memory raises it");
  EXPECT_TRUE(actions.end);
  EXPECT_FALSE(supervisor_.workerExceeded(1, "").end);  // it is ending
  const auto ended = supervisor_.workerEnded(3, {.signal = SIGKILL});
  EXPECT_TRUE(ended.hold) << "the same program would need as much again";
  EXPECT_THAT(states(ended), ElementsAre("hung", "waiting"));
  EXPECT_THAT(ended.toPage.front(), HasSubstr("needs more than 1.0 GiB of memory, the limit; --max-memory raises it"));
  EXPECT_TRUE(supervisor_.workerExceeded(1, "").end);
  const auto again = supervisor_.workerEnded(4, {.signal = SIGKILL});
  EXPECT_FALSE(again.start) << "the limit is too low for any program";
  EXPECT_THAT(states(again), ElementsAre("hung"));
  EXPECT_TRUE(supervisor_.pageSent(5, kOpen).start);
}

TEST_F(SessionSupervisorTest, RestartsAfterACrashWithTheViewAndDefaultParameters) {
  open();
  const auto actions = supervisor_.workerEnded(3, {.signal = SIGSEGV});
  EXPECT_TRUE(actions.start);
  EXPECT_FALSE(actions.hold);
  EXPECT_THAT(states(actions), ElementsAre("crashed", "started"));
  EXPECT_THAT(actions.toPage.front(), HasSubstr("signal 11"));
  const Json open = only(actions.toWorker);
  EXPECT_EQ(open.at("program"), "mine");
  EXPECT_EQ(open.at("width"), 64);
  EXPECT_EQ(open.at("samples"), 8);
  EXPECT_EQ(open.at("camera").at("from"), Json({1, 2, 3}));
  EXPECT_FALSE(open.contains("parameters"));
  EXPECT_FALSE(open.contains("id"));
}

TEST_F(SessionSupervisorTest, TriesAgainWithTheNextCommandIfAWorkerCannotBeStarted) {
  open();
  EXPECT_TRUE(supervisor_.workerEnded(3, {.signal = SIGSEGV}).start);
  const auto actions = supervisor_.workerMissing("no processes left");
  EXPECT_FALSE(actions.start);
  EXPECT_FALSE(actions.end);
  EXPECT_THAT(states(actions), ElementsAre("crashed"));
  EXPECT_EQ(only(actions.toPage).at("message"), "no processes left");
  EXPECT_FALSE(supervisor_.tick(200).start);
  const auto next = supervisor_.pageSent(201, R"({"do":"zoom","factor":2})");
  EXPECT_TRUE(next.start);
  EXPECT_THAT(states(next), ElementsAre("started"));
  EXPECT_EQ(next.toWorker.size(), 2u) << "what was open, and the command";
}

TEST_F(SessionSupervisorTest, KeepsParametersIfTheWorkerWasKilled) {
  open();
  const auto actions = supervisor_.workerEnded(3, {.signal = SIGKILL});
  EXPECT_FALSE(actions.hold);
  EXPECT_EQ(only(actions.toWorker).at("parameters").at("n"), 2);
}

TEST_F(SessionSupervisorTest, WaitsAfterASecondCrashInSequence) {
  open();
  supervisor_.workerEnded(3, {.signal = SIGSEGV});
  const auto actions = supervisor_.workerEnded(5, {.status = 1});
  EXPECT_TRUE(actions.start);
  EXPECT_TRUE(actions.hold);
  EXPECT_THAT(states(actions), ElementsAre("crashed", "waiting"));
  EXPECT_FALSE(supervisor_.workerEnded(50, {.signal = SIGSEGV}).hold);  // much later
}

TEST_F(SessionSupervisorTest, WaitsAfterAnEndlessShader) {
  open();
  const auto actions = supervisor_.workerEnded(5, {.status = 70, .hung = "a launch did not end within 2 s"});
  EXPECT_TRUE(actions.hold);
  EXPECT_THAT(states(actions), ElementsAre("hung", "waiting"));
  EXPECT_THAT(actions.toPage.front(), HasSubstr("within 2 s"));
}

TEST_F(SessionSupervisorTest, EndsAWorkerThatDoesNotAnswer) {
  open();
  EXPECT_FALSE(supervisor_.tick(60).end);
  supervisor_.workerAlive(60);
  EXPECT_FALSE(supervisor_.tick(90).end);
  EXPECT_TRUE(supervisor_.tick(99).end == false);
  supervisor_.pageSent(100, R"({"do":"pause"})");
  const auto actions = supervisor_.tick(123);
  EXPECT_TRUE(actions.end);
  EXPECT_FALSE(supervisor_.tick(124).end);  // once
  EXPECT_THAT(states(supervisor_.workerEnded(124, {.signal = SIGKILL})), ElementsAre("hung", "waiting"));
}

TEST_F(SessionSupervisorTest, EndsAnIdleWorkerAndContinuesWithTheNextCommand) {
  open();
  supervisor_.workerAlive(101);
  const auto idle = supervisor_.tick(102);
  EXPECT_TRUE(idle.end);
  EXPECT_THAT(states(idle), ElementsAre("idle"));
  EXPECT_THAT(supervisor_.workerEnded(102, {.signal = SIGKILL}).toPage, IsEmpty());
  EXPECT_FALSE(supervisor_.tick(300).end);
  EXPECT_FALSE(supervisor_.pageSent(301, R"({"do":"received","image":1})").start);
  const auto actions = supervisor_.pageSent(302, R"({"do":"orbit","dx":1})");
  EXPECT_TRUE(actions.start);
  ASSERT_EQ(actions.toWorker.size(), 2u);
  EXPECT_EQ(Json::parse(actions.toWorker[0]).at("parameters").at("n"), 2);
  EXPECT_EQ(Json::parse(actions.toWorker[1]).at("do"), "orbit");
}

TEST_F(SessionSupervisorTest, AnIdleSessionThatOpensDoesNotResume) {
  open();
  supervisor_.workerAlive(101);
  supervisor_.tick(102);
  const auto actions = supervisor_.pageSent(103, R"({"do":"open","program":"other"})");
  EXPECT_TRUE(actions.start);
  EXPECT_EQ(only(actions.toWorker).at("program"), "other");
}

TEST_F(SessionSupervisorTest, EndsADriverThatCompilesLongerThanALaunchMayTake) {
  open();
  supervisor_.workerSent(10, R"({"event":"stage","text":"compiling shaders"})");
  EXPECT_FALSE(supervisor_.tick(9.9 + kCompileSeconds).end);
  EXPECT_TRUE(supervisor_.tick(10.1 + kCompileSeconds).end);
  EXPECT_FALSE(supervisor_.tick(10.6 + kCompileSeconds).end) << "once";
  const auto actions = supervisor_.workerEnded(20.7, {.signal = SIGKILL});
  EXPECT_THAT(states(actions), ElementsAre("hung", "waiting"));
  EXPECT_THAT(actions.toPage.front(), HasSubstr("within 10 s"));
  EXPECT_TRUE(actions.hold);
}

TEST_F(SessionSupervisorTest, CompilingHasTheTimeOfALaunch) {
  SessionSupervisor supervisor({.timeout = 30, .idleSeconds = 100});
  supervisor.connected(0);
  supervisor.pageSent(1, kOpen);
  supervisor.workerSent(2, R"({"event":"stage","text":"compiling shaders"})");
  EXPECT_FALSE(supervisor.tick(31.9).end);
  EXPECT_TRUE(supervisor.tick(32.1).end);
}

TEST_F(SessionSupervisorTest, GivesOtherWorkMoreTime) {
  open();
  supervisor_.workerSent(10, R"({"event":"stage","text":"compiling shaders"})");
  supervisor_.workerSent(11, R"({"event":"stage","text":"loading fox.glb"})");
  EXPECT_FALSE(supervisor_.tick(14).end);
  EXPECT_FALSE(supervisor_.tick(11 + kStuckSeconds).end);
  EXPECT_TRUE(supervisor_.tick(13.1 + kStuckSeconds).end);
}

TEST_F(SessionSupervisorTest, AVideoInProgressKeepsTheSessionInUse) {
  open();
  for (double now = 50; now <= 400; now += 50) {
    supervisor_.workerSent(now, R"({"event":"progress","done":1,"total":9})");
    EXPECT_FALSE(supervisor_.tick(now + 1).end);
  }
}

TEST_F(SessionSupervisorTest, RestartsOnRequest) {
  open();
  const auto actions = supervisor_.pageSent(5, R"({"do":"restart"})");
  EXPECT_TRUE(actions.end);
  EXPECT_TRUE(actions.start);
  EXPECT_FALSE(actions.hold);
  EXPECT_EQ(only(actions.toWorker).at("do"), "open");
}

}  // namespace
}  // namespace quintet::lab
