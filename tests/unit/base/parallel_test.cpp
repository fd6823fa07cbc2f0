// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace quintet {
namespace {

TEST(ParallelTest, CallsEachIndexOnce) {
  for (const std::size_t count : {0u, 1u, 2u, 7u, 10000u}) {
    std::vector<std::atomic<int>> calls(count);
    parallelFor(count, [&](std::size_t i) { ++calls.at(i); });
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(calls[i], 1) << i << " of " << count;
  }
}

TEST(ParallelTest, RethrowsExceptionsAndSkipsTheRest) {
  std::atomic<std::size_t> calls{0};
  EXPECT_THROW(parallelFor(1000000,
                           [&](std::size_t i) {
                             ++calls;
                             if (i == 10) throw std::runtime_error("ten");
                             std::this_thread::yield();
                           }),
               std::runtime_error);
  EXPECT_LT(calls, 1000000u);
}

TEST(ParallelTest, RunsNestedLoops) {
  std::atomic<int> calls{0};
  parallelFor(8, [&](std::size_t) { parallelFor(8, [&](std::size_t) { ++calls; }); });
  EXPECT_EQ(calls, 64);
  EXPECT_THROW(
      parallelFor(4, [](std::size_t) { parallelFor(4, [](std::size_t) { throw std::logic_error("inner"); }); }),
      std::logic_error);
}

// Each task above 0 adds two smaller ones: a binary tree of 2^10 - 1 tasks.
TEST(ParallelTest, RunsTasksThatAddTasks) {
  std::atomic<int> calls{0};
  const auto halve = [&](int depth, TaskList<int>& list) {
    ++calls;
    for (int child = 0; depth > 0 && child < 2; ++child) list.add(depth - 1);
  };
  parallelTasks(std::vector<int>{9}, halve);
  EXPECT_EQ(calls, 1023);
  calls = 0;
  parallelTasks(std::vector<int>{}, halve);
  EXPECT_EQ(calls, 0);
  parallelFor(2, [&](std::size_t) { parallelTasks(std::vector<int>{4, 4}, halve); });  // nested
  EXPECT_EQ(calls, 4 * 31);
  EXPECT_THROW(parallelTasks(std::vector<int>{9},
                             [&](int depth, TaskList<int>& list) {
                               if (depth == 5) throw std::runtime_error("five");
                               halve(depth, list);
                             }),
               std::runtime_error);
}

TEST(ParallelTest, UsesAllCoresForTasks) {
  if (hardwareThreads() < 2) GTEST_SKIP() << "one core";
  std::atomic<int> inside{0};
  std::atomic<bool> together{false};
  parallelTasks(std::vector<int>{0}, [&](int depth, TaskList<int>& list) {
    if (depth == 0) {
      list.add(1);
      list.add(1);
      return;
    }
    ++inside;
    for (int wait = 0; wait < 5000 && !together; ++wait) {  // until the other task arrives
      if (inside == 2) together = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_TRUE(together);
}

TEST(ParallelTest, UsesAllCoresForALoopInsideASingleIteration) {
  if (hardwareThreads() < 2) GTEST_SKIP() << "one core";
  std::atomic<int> inside{0};
  std::atomic<bool> together{false};
  parallelFor(1, [&](std::size_t) {
    parallelFor(2, [&](std::size_t) {
      ++inside;
      for (int wait = 0; wait < 5000 && !together; ++wait) {  // until the other iteration arrives
        if (inside == 2) together = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  });
  EXPECT_TRUE(together);
}

TEST(ParallelTest, CoversAllRangesAndCopiesBytes) {
  for (const std::size_t count : {0u, 1u, 9u, 10u, 11u, 1005u}) {
    std::vector<std::atomic<int>> calls(count);
    parallelRanges(
        count,
        [&](std::size_t first, std::size_t last) {
          EXPECT_LE(last - first, 10u);
          for (std::size_t i = first; i < last; ++i) ++calls.at(i);
        },
        10);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(calls[i], 1) << i << " of " << count;
  }
  std::vector<std::byte> from((std::size_t{9} << 20) + 3), to(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<std::byte>(i * 7 + i / 4096);
  parallelCopy(to.data(), from);
  EXPECT_EQ(from, to);
}

TEST(ParallelTest, RespectsTheCpuAffinity) {
  EXPECT_GE(hardwareThreads(), 1u);
  // The affinity belongs to the thread, so the test sets it in a new one.
  std::jthread([] {
    cpu_set_t all;
    ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu)
      if (CPU_ISSET(cpu, &all)) CPU_SET(cpu, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(hardwareThreads(), 1u);
    const auto self = std::this_thread::get_id();
    parallelFor(100, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), self); });
  });
}

}  // namespace
}  // namespace quintet
