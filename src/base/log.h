// SPDX-License-Identifier: Apache-2.0
// Log callbacks. The library never prints; the application passes a sink for messages that are not errors.
#ifndef QUINTET_BASE_LOG_H
#define QUINTET_BASE_LOG_H

#include <functional>
#include <string>

namespace quintet {

enum class LogLevel { debug, info, warning };

// Receives one line without a trailing newline. It may be called from any thread; an empty sink discards the message.
using LogSink = std::function<void(LogLevel, const std::string&)>;

}  // namespace quintet
#endif
