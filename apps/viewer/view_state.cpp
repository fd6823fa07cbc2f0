// SPDX-License-Identifier: Apache-2.0
#include "view_state.h"

#include <utility>

namespace quintet::viewer {
namespace {

constexpr double kNoteSeconds = 4.0;
constexpr double kErrorSeconds = 10.0;
constexpr std::size_t kMaxToasts = 4;
constexpr std::size_t kMaxLog = 500;

}  // namespace

void ViewState::addMessage(Message message) {
  if (log.size() >= kMaxLog) log.erase(log.begin());
  log.push_back(message);
  const double seconds = message.kind == Message::Kind::note ? kNoteSeconds : kErrorSeconds;
  std::erase_if(toasts, [&](const Toast& toast) { return toast.message.text == message.text; });  // shown once
  if (toasts.size() >= kMaxToasts) toasts.erase(toasts.begin());
  toasts.push_back({std::move(message), time + seconds});
}

}  // namespace quintet::viewer
