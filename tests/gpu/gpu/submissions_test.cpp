// SPDX-License-Identifier: Apache-2.0
// Order, waiting, retirement and errors of submissions.
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gpu/commands.h"
#include "gpu/compute.h"
#include "gpu/error.h"
#include "gpu/timer.h"
#include "harness.h"

namespace quintet::gpu {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

// A shader whose single invocation runs for a large part of a second.
class Busy {
 public:
  explicit Busy(Context& context)
      : set_(context, 0, 16),
        pipeline_(context, set_, test::compileCompute(R"(#version 460
          #extension GL_EXT_scalar_block_layout : require
          #extension GL_EXT_buffer_reference : require
          layout(buffer_reference, scalar) buffer Result { uint value; };
          layout(push_constant, scalar) uniform Constants { Result result; uint rounds; };
          void main() {
            uint x = 1u;
            for (uint i = 0u; i < rounds; ++i) x = x * 1664525u + (x >> 7) + i;
            result.value = x;
          })"),
                  VK_NULL_HANDLE, "busy"),
        result_(context, {.size = 4, .name = "busy result"}) {}

  void record(Commands& commands, std::uint32_t rounds = 50'000'000) const {
    struct {
      VkDeviceAddress result;
      std::uint32_t rounds, padding;
    } constants{result_.address(), rounds, 0};
    pipeline_.dispatch(commands, std::as_bytes(std::span(&constants, 1)), 1);
  }

 private:
  BindlessSet set_;
  ComputePipeline pipeline_;
  Buffer result_;
};

TEST(GpuSubmissions, CountsOnATimeline) {
  Context& context = test::testContext();
  const std::uint64_t before = context.submitted();
  const std::uint64_t first = context.submit([](Commands&) {});
  const std::uint64_t second = context.submit([](Commands&) {});
  EXPECT_EQ(first, before + 1);
  EXPECT_EQ(second, before + 2);
  EXPECT_EQ(context.submitted(), second);
  context.wait(second);
  EXPECT_GE(context.completed(), second);
  context.wait(first, 0.001);  // reached before
}

TEST(GpuSubmissions, SeesMemoryOfEarlierSubmissions) {
  Context& context = test::testContext();
  const Buffer a(context, {.size = 4096, .name = "a"});
  const Buffer b(context, {.size = 4096, .name = "b"});
  std::uint64_t last = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {  // more than the maximum in flight
    context.submit([&](Commands& commands) { commands.fill(a, i); });
    last = context.submit([&](Commands& commands) { commands.copy(a, b, 4096); });
  }
  context.wait(last);
  EXPECT_EQ(b.downloadAs<std::uint32_t>(1024), std::vector<std::uint32_t>(1024, 199));
}

TEST(GpuSubmissions, ThrowsAfterTheTimeout) {
  Context context({.device = test::testContext().info().name});
  const Busy busy(context);
  const std::uint64_t value = context.submit([&](Commands& commands) { busy.record(commands); });
  EXPECT_THAT([&] { context.wait(value, 0.001); },
              ThrowsMessage<DeviceLostError>(testing::StrEq("the device did not finish within 0.001 s")));
  EXPECT_LT(context.completed(), value);
  context.wait(value);  // the device was only slow
  EXPECT_EQ(context.completed(), value);
  const Buffer buffer = makeBufferOf(context, std::vector<int>{1}, 0, "still alive");
  EXPECT_EQ(buffer.downloadAs<int>(1), std::vector<int>{1});
}

TEST(GpuSubmissions, RecoversFromExceptionsDuringRecording) {
  Context& context = test::testContext();
  const std::uint64_t before = context.submitted();
  const Buffer buffer(context, {.size = 64, .name = "half recorded"});
  for (int i = 0; i < 3; ++i)
    EXPECT_THAT(
        [&] {
          context.submit([&](Commands& commands) {
            commands.fill(buffer, 1);
            throw std::runtime_error("the recorder fails");
          });
        },
        ThrowsMessage<std::runtime_error>(HasSubstr("the recorder fails")));
  EXPECT_EQ(context.submitted(), before);
  context.submitAndWait([&](Commands& commands) { commands.fill(buffer, 2); });
  EXPECT_EQ(buffer.downloadAs<std::uint32_t>(16), std::vector<std::uint32_t>(16, 2));
}

TEST(GpuSubmissions, RetiresInOrderAfterTheWork) {
  Context& context = test::testContext();
  const Busy busy(context);
  context.wait(context.submitted());
  std::vector<int> order;
  const std::uint64_t first = context.submit([&](Commands& commands) { busy.record(commands); });
  context.retire([&] { order.push_back(1); });
  context.retire([&] { order.push_back(2); });
  const std::uint64_t second = context.submit([&](Commands& commands) { busy.record(commands); });
  context.retire([&] { order.push_back(3); });
  EXPECT_TRUE(order.empty()) << "the device is still busy";
  context.wait(first);
  EXPECT_THAT(order, ElementsAre(1, 2));
  context.wait(second);
  EXPECT_THAT(order, ElementsAre(1, 2, 3));
  context.retire([&] { order.push_back(4); });
  EXPECT_THAT(order, ElementsAre(1, 2, 3, 4)) << "nothing is pending";
}

TEST(GpuSubmissions, RetiresAfterTheWorkThatIsBeingRecorded) {
  Context& context = test::testContext();
  const Busy busy(context);
  context.wait(context.submitted());
  const Buffer target(context, {.size = 1 << 20, .name = "target"});
  bool destroyed = false;
  const std::uint64_t value = context.submit([&](Commands& commands) {
    const Buffer scratch(context, {.size = 1 << 20, .name = "destroyed during recording"});
    busy.record(commands);
    commands.fill(scratch, 5);
    commands.barrier(Stage::all, Stage::all);
    commands.copy(scratch, target, 1 << 20);
    context.retire([&] { destroyed = true; });
    context.submit([](Commands&) {});  // a nested submission has the previous value
  });
  EXPECT_FALSE(destroyed);
  context.wait(value);
  EXPECT_TRUE(destroyed);
  EXPECT_EQ(target.downloadAs<std::uint32_t>(1 << 18), std::vector<std::uint32_t>(1 << 18, 5));
}

TEST(GpuSubmissions, RetiresInTheDestructor) {
  int destroyed = 0;
  {
    Context context({.device = test::testContext().info().name});
    const Busy busy(context);
    context.submit([&](Commands& commands) { busy.record(commands); });
    context.retire([&] { ++destroyed; });
    const Buffer buffer(context, {.size = 64, .name = "destroyed while the device works"});
    EXPECT_EQ(destroyed, 0);
  }
  EXPECT_EQ(destroyed, 1);
}

TEST(GpuSubmissions, SupportsManyThreads) {
  Context& context = test::testContext();
  const Buffer counter = makeBufferOf(context, std::vector<std::uint32_t>(8, 0), 0, "counters");
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint32_t i = 1; i <= 50; ++i) {
        const Buffer source = makeBufferOf(context, std::vector<std::uint32_t>{i * (t + 1)}, 0, "source");
        context.wait(context.submit([&](Commands& commands) { commands.copy(source, counter, 4, 0, 4 * t); }));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(counter.downloadAs<std::uint32_t>(8), ElementsAre(50, 100, 150, 200, 250, 300, 350, 400));
}

TEST(GpuTimer, MeasuresWork) {
  Context& context = test::testContext();
  const Busy busy(context);
  Timer timer(context, 3);
  for (int repeat = 0; repeat < 2; ++repeat) {
    context.submitAndWait([&](Commands& commands) {
      timer.reset(commands);
      timer.mark(commands, 0);
      busy.record(commands, 1'000'000);
      timer.mark(commands, 1);
      commands.barrier(Stage::all, Stage::all);
      busy.record(commands, 20'000'000);
      timer.mark(commands, 2);
    });
    EXPECT_GT(timer.seconds(0, 1), 0.0);
    EXPECT_GT(timer.seconds(1, 2), timer.seconds(0, 1));
    EXPECT_LT(timer.seconds(0, 2), 60.0);
    EXPECT_NEAR(timer.seconds(0, 1) + timer.seconds(1, 2), timer.seconds(0, 2), 1e-6);
  }
}

}  // namespace
}  // namespace quintet::gpu
