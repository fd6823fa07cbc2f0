// SPDX-License-Identifier: Apache-2.0
#include "shader/deep_stack.h"

#include <pthread.h>

#include <algorithm>

namespace quintet::shader {

std::size_t stackBytesFor(std::size_t textBytes) {
  return std::min((std::size_t{64} << 20) + textBytes * 1024, std::size_t{1} << 30);
}

void runOnDeepStack(std::size_t bytes, const std::function<void()>& body) {
  const auto entry = [](void* argument) -> void* {
    (*static_cast<const std::function<void()>*>(argument))();
    return nullptr;
  };
  constexpr std::size_t kSmallest = std::size_t{8} << 20;
  for (; bytes >= kSmallest; bytes /= 2) {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_t thread{};
    const bool started = pthread_attr_setstacksize(&attributes, bytes) == 0 &&
                         pthread_create(&thread, &attributes, entry, const_cast<std::function<void()>*>(&body)) == 0;
    pthread_attr_destroy(&attributes);
    if (started) {
      pthread_join(thread, nullptr);
      return;
    }
  }
  body();
}

}  // namespace quintet::shader
