// SPDX-License-Identifier: Apache-2.0
#include "base/cancellation.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include <quintet/cancellation.h>

#include "base/parallel.h"

namespace quintet {
namespace {

TEST(Cancellation, EndsLoopsOnAllCores) {
  std::atomic<bool> canceled{false};
  Cancellation cancellation([&] { return canceled.load(); });
  const Cancellation::Scope scope(&cancellation);
  std::atomic<int> calls{0};
  EXPECT_THROW(parallelFor(1'000'000,
                           [&](std::size_t) {
                             if (++calls == 100) canceled = true;
                             std::this_thread::sleep_for(std::chrono::microseconds(100));
                           }),
               CanceledError);
  EXPECT_LT(calls, 100'000);
  EXPECT_THROW(throwIfCanceled(), CanceledError) << "a cancellation is final";
}

TEST(Cancellation, AsksOnlyItsOwnThread) {
  const auto owner = std::this_thread::get_id();
  std::atomic<bool> elsewhere{false};
  Cancellation cancellation([&] {
    elsewhere = elsewhere || std::this_thread::get_id() != owner;
    return false;
  });
  const Cancellation::Scope scope(&cancellation);
  parallelFor(1000, [](std::size_t) { std::this_thread::sleep_for(std::chrono::microseconds(50)); });
  EXPECT_FALSE(elsewhere);
}

TEST(Cancellation, EndsTheWaitForAnotherThread) {
  std::atomic<bool> canceled{false};
  Cancellation cancellation([&] { return canceled.load(); });
  const Cancellation::Scope scope(&cancellation);
  std::future<int> result = std::async(std::launch::async, [&]() -> int {
    const Cancellation::Scope ofThread(&cancellation);
    canceled = true;
    for (;;) {
      throwIfCanceled();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_THROW(getUnlessCanceled(result), CanceledError);
}

TEST(Cancellation, ScopesNest) {
  Cancellation outer([] { return true; });
  const Cancellation::Scope scope(&outer);
  {
    const Cancellation::Scope none(nullptr);
    EXPECT_NO_THROW(throwIfCanceled());
  }
  EXPECT_THROW(throwIfCanceled(), CanceledError);
}

}  // namespace
}  // namespace quintet
