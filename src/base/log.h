// How a library reports what is not an error: the app passes a sink, the library never prints.
#ifndef QUINTET_BASE_LOG_H
#define QUINTET_BASE_LOG_H

#include <functional>
#include <string>

namespace quintet {

enum class LogLevel { debug, info, warning };

// May be called from any thread; an empty sink drops the message. One line, no trailing newline.
using LogSink = std::function<void(LogLevel, const std::string&)>;

}  // namespace quintet
#endif
