// SPDX-License-Identifier: Apache-2.0
#include "base/cancellation.h"

#include <quintet/cancellation.h>

namespace quintet {

thread_local Cancellation* Cancellation::current_ = nullptr;

bool Cancellation::requested() {
  if (requested_) return true;
  if (!isCanceled_ || std::this_thread::get_id() != owner_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (asked_ != std::chrono::steady_clock::time_point{} &&
      std::chrono::duration<double>(now - asked_).count() < kAskSeconds)
    return false;
  asked_ = now;
  if (isCanceled_()) requested_ = true;
  return requested_;
}

void throwIfCanceled() {
  if (Cancellation* cancellation = Cancellation::current(); cancellation && cancellation->requested())
    throw CanceledError("canceled");
}

}  // namespace quintet
