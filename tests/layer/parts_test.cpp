// SPDX-License-Identifier: Apache-2.0
// Parts of the layer that need no device: the cache of modules, the loop that waiting threads join, and the lengths of descriptor
// arrays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "descriptor_layouts.h"
#include "link_worker.h"
#include "module_cache.h"

namespace quintet::layer {
namespace {

using testing::ElementsAre;
using testing::Pair;

Hash keyOf(int number) { return Hasher().add(static_cast<std::uint64_t>(number)).finish(); }

CachedStage stageOf(std::size_t words) {
  CachedStage stage;
  stage.module.spirv.resize(words);
  stage.recordBytes = words;
  return stage;
}

TEST(ModuleCache, KeepsWhatWasUsedLast) {
  constexpr std::size_t kWords = 1000;
  ModuleCache cache(3 * kWords * sizeof(std::uint32_t) + 3000);
  for (int i = 0; i < 3; ++i) cache.add(keyOf(i), stageOf(kWords));
  ASSERT_TRUE(cache.find(keyOf(0)));
  cache.add(keyOf(3), stageOf(kWords));
  EXPECT_TRUE(cache.find(keyOf(0)));
  EXPECT_FALSE(cache.find(keyOf(1)));
  EXPECT_EQ(cache.find(keyOf(3))->recordBytes, kWords);
  cache.add(keyOf(4), stageOf(100 * kWords));  // larger than the cache
  EXPECT_FALSE(cache.find(keyOf(4)));
}

TEST(LinkWorker, WaitingThreadsTakePart) {
  LinkWorker worker;
  const std::thread::id waiting = std::this_thread::get_id();
  std::atomic<bool> takesPart = false;
  std::atomic<bool> started = false;
  const auto task = worker.add([&] {
    started = true;
    worker.loop(64, [&](std::size_t) {
      if (std::this_thread::get_id() == waiting) takesPart = true;
      if (!takesPart) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    });
  });
  while (!started) std::this_thread::yield();
  worker.wait(task);
  EXPECT_TRUE(worker.isDone(*task));
  EXPECT_TRUE(takesPart);
}

TEST(LinkWorker, TasksThatWereNotStartedRunOnTheWaitingThread) {
  LinkWorker worker;
  std::atomic<bool> goesOn = false;
  const auto first = worker.add([&] {
    while (!goesOn) std::this_thread::yield();
  });
  std::thread::id runner;
  worker.wait(worker.add([&] { runner = std::this_thread::get_id(); }));
  EXPECT_EQ(runner, std::this_thread::get_id());
  goesOn = true;
  worker.wait(first);
}

TEST(LinkWorker, CallsEachOnceHoweverManyThreadsWait) {
  for (int round = 0; round < 50; ++round) {
    LinkWorker worker;
    std::vector<std::atomic<int>> calls(97);
    std::vector<std::shared_ptr<LinkWorker::Task>> tasks;
    for (int t = 0; t < 3; ++t)
      tasks.push_back(worker.add([&] { worker.loop(calls.size(), [&](std::size_t i) { ++calls[i]; }); }));
    std::vector<std::thread> threads;
    for (int k = 0; k < 3; ++k) threads.emplace_back([&, k] { worker.wait(tasks[static_cast<std::size_t>(2 - k)]); });
    worker.waitForAll();
    for (std::thread& thread : threads) thread.join();
    for (const auto& count : calls) ASSERT_EQ(count, 3);
  }
}

TEST(SharedLoop, RethrowsAndCanRunAgain) {
  SharedLoop loop;
  const auto fails = [](std::size_t i) {
    if (i == 3) throw std::runtime_error("three");
  };
  EXPECT_THROW(loop.run(8, fails, [] {}), std::runtime_error);
  std::atomic<int> calls = 0;
  loop.run(
      8, [&](std::size_t) { ++calls; }, [] {});
  EXPECT_EQ(calls, 8);
  loop.join();  // no loop runs
}

template <class Handle>
Handle handleOf(std::uint64_t number) {
  return reinterpret_cast<Handle>(number);
}

TEST(DescriptorLayouts, KnowsTheCountsOfLayoutsAndBoundSets) {
  DescriptorLayouts layouts;
  const VkDescriptorSetLayoutBinding bindings[] = {
      {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 3, VK_SHADER_STAGE_ALL, nullptr},
      {2, VK_DESCRIPTOR_TYPE_INLINE_UNIFORM_BLOCK, 64, VK_SHADER_STAGE_ALL, nullptr},
      {7, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, 100, VK_SHADER_STAGE_ALL, nullptr}};
  const VkDescriptorBindingFlags flags[] = {0, 0, VK_DESCRIPTOR_BINDING_VARIABLE_DESCRIPTOR_COUNT_BIT};
  const VkDescriptorSetLayoutBindingFlagsCreateInfo flagsInfo{
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_BINDING_FLAGS_CREATE_INFO, nullptr, 3, flags};
  const auto setLayout = handleOf<VkDescriptorSetLayout>(1);
  layouts.addSetLayout(setLayout, {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, &flagsInfo, 0, 3, bindings});
  const VkDescriptorSetLayout sets[] = {VK_NULL_HANDLE, setLayout};
  const auto layout = handleOf<VkPipelineLayout>(2);
  layouts.addPipelineLayout(layout, {VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, nullptr, 0, 2, sets, 0, nullptr});
  const auto pool = handleOf<VkDescriptorPool>(3);
  const auto set = handleOf<VkDescriptorSet>(4);
  const std::uint32_t count = 10;
  const VkDescriptorSetVariableDescriptorCountAllocateInfo variable{
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_VARIABLE_DESCRIPTOR_COUNT_ALLOCATE_INFO, nullptr, 1, &count};
  layouts.addSets({VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, &variable, pool, 1, &setLayout}, &set);
  layouts.removeSetLayout(setLayout);  // the pipeline layout keeps it
  const DescriptorCounts counts = layouts.countsOf(layout);
  EXPECT_THAT(counts, ElementsAre(Pair(Pair(1, 1), 3), Pair(Pair(1, 7), 100)));
  const auto commands = handleOf<VkCommandBuffer>(5);
  const auto bound = [&] { return layouts.withBoundSets(counts, commands).at({1, 7}); };
  EXPECT_EQ(bound(), 100u);
  layouts.bind(commands, 1, 1, &set);
  EXPECT_EQ(bound(), 10u);
  const auto other = handleOf<VkDescriptorSet>(6);
  layouts.bind(commands, 1, 1, &other);
  EXPECT_EQ(bound(), 100u);
  layouts.bind(commands, 1, 1, &set);
  layouts.forget(commands);
  EXPECT_EQ(bound(), 100u);
  layouts.removePool(pool);
  layouts.bind(commands, 1, 1, &set);
  EXPECT_EQ(bound(), 100u);
  layouts.removePipelineLayout(layout);
  EXPECT_TRUE(layouts.countsOf(layout).empty());
}

}  // namespace
}  // namespace quintet::layer
