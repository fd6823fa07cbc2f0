// SPDX-License-Identifier: Apache-2.0
#include "messages.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "check/diagnostic_text.h"
#include "check/sarif.h"
#include "check/sources.h"

namespace quintet::layer {
namespace {

constexpr const char* kName = "quintet link check";

VkDebugUtilsMessageSeverityFlagBitsEXT severityOf(Severity severity) {
  switch (severity) {
    case Severity::error: return VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    case Severity::warning: return VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
    case Severity::note: break;
  }
  return VK_DEBUG_UTILS_MESSAGE_SEVERITY_INFO_BIT_EXT;
}

bool isSame(const Diagnostic& a, const Diagnostic& b) {
  return a.id == b.id && a.file == b.file && a.line == b.line && a.text == b.text;
}

// "pipeline 'sky' (0x55d0c8)"
std::string describe(const MessageObject& object) {
  if (object.handle == 0) return {};
  const char* type = object.type == VK_OBJECT_TYPE_PIPELINE ? "pipeline" : "object";
  return object.name.empty() ? fmt::format("{} {:#x}", type, object.handle)
                             : fmt::format("{} '{}' ({:#x})", type, object.name, object.handle);
}

}  // namespace

Messages::Messages(const Settings& settings)
    : output_(settings.output), sarif_(settings.output.extension() == ".sarif") {
  for (const std::string& problem : settings.problems) note(problem);
  if (settings.suppressions.empty()) return;
  try {
    suppressions_ = check::SuppressionList::parse(settings.suppressions, readTextFile(settings.suppressions));
  } catch (const Error& error) {
    note(error.what());
  }
}

Messages::~Messages() { finish(); }

void Messages::finish() {
  const std::scoped_lock lock(mutex_);
  if (std::exchange(finished_, true)) return;
  std::string counts;
  for (const Known& known : known_)
    if (known.count > 1)
      counts += fmt::format("{}: {} occurred {} times\n", locationText(known.diagnostic.file, known.diagnostic.line, 0),
                            known.diagnostic.id, known.count);
  if (output_.empty()) {
    std::fputs(counts.c_str(), stderr);
    return;
  }
  if (!sarif_) text_ += counts;
  if (!known_.empty() || sarif_) writeFile(true);
}

void Messages::note(const std::string& text) { std::fprintf(stderr, "%s: %s\n", kName, text.c_str()); }

void Messages::addMessenger(VkDebugUtilsMessengerEXT handle, const VkDebugUtilsMessengerCreateInfoEXT& info) {
  const std::scoped_lock lock(mutex_);
  messengers_.push_back({handle, info});
}

void Messages::removeMessenger(VkDebugUtilsMessengerEXT handle) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(messengers_, [&](const Messenger& messenger) { return messenger.handle == handle; });
}

void Messages::removeMessengers() {
  const std::scoped_lock lock(mutex_);
  messengers_.clear();
}

void Messages::report(const std::vector<Diagnostic>& diagnostics, const MessageObject& object,
                      const std::map<std::string, std::string>& sources) {
  std::vector<std::pair<Diagnostic, std::string>> sent;
  {
    const std::scoped_lock lock(mutex_);
    sources_.insert(sources.begin(), sources.end());
    std::vector<Diagnostic> accepted = diagnostics;
    for (check::SuppressedDiagnostic& s : suppressions_.apply(accepted)) suppressed_.push_back(std::move(s));
    for (const Diagnostic& d : accepted) {
      const auto found = std::ranges::find_if(known_, [&](const Known& known) { return isSame(known.diagnostic, d); });
      if (found != known_.end()) {
        ++found->count;
        continue;
      }
      known_.push_back({d, 1});
      const std::string text = textOf(d, object);
      sent.emplace_back(d, text);
      text_ += text;
    }
    if (!output_.empty() && !sent.empty()) writeFile(false);
  }
  for (const auto& [d, text] : sent) send(d, object, text);
}

std::string Messages::textOf(const Diagnostic& d, const MessageObject& object) const {
  const check::SourceLookup sources = [&](const std::string& file) {
    const auto found = sources_.find(file);
    return found == sources_.end() ? check::sourcesOnDisk()(file) : std::optional(found->second);
  };
  std::string text = check::diagnosticsText({d}, sources);
  if (const std::string owner = describe(object); !owner.empty()) text += fmt::format("      = in: {}\n", owner);
  return text;
}

// Calls the messengers without the lock: a callback can call Vulkan.
void Messages::send(const Diagnostic& d, const MessageObject& object, const std::string& text) {
  std::vector<Messenger> messengers;
  {
    const std::scoped_lock lock(mutex_);
    messengers = messengers_;
  }
  const VkDebugUtilsMessageSeverityFlagBitsEXT severity = severityOf(d.severity);
  constexpr VkDebugUtilsMessageTypeFlagsEXT kType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  VkDebugUtilsObjectNameInfoEXT name{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, object.type,
                                     object.handle, object.name.empty() ? nullptr : object.name.c_str()};
  VkDebugUtilsMessengerCallbackDataEXT data{};
  data.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CALLBACK_DATA_EXT;
  data.pMessageIdName = d.id.c_str();
  if (d.id.size() > 1) std::from_chars(d.id.data() + 1, d.id.data() + d.id.size(), data.messageIdNumber);
  data.pMessage = text.c_str();
  data.objectCount = object.handle != 0 ? 1 : 0;
  data.pObjects = &name;
  for (const Messenger& messenger : messengers)
    if ((messenger.info.messageSeverity & severity) != 0 && (messenger.info.messageType & kType) != 0)
      messenger.info.pfnUserCallback(severity, kType, &data, messenger.info.pUserData);
  if (messengers.empty() && output_.empty()) std::fputs(text.c_str(), stderr);
}

void Messages::writeFile(bool complete) {
  if (fileFailed_) return;
  try {
    if (!sarif_) return quintet::writeFile(output_, text_);
    std::vector<Diagnostic> all;
    for (const Known& known : known_) {
      all.push_back(known.diagnostic);
      if (known.count > 1) all.back().text += fmt::format(" (occurred {} times)", known.count);
    }
    const check::SourceLookup sources = [&](const std::string& file) {
      const auto found = sources_.find(file);
      return found == sources_.end() ? check::sourcesOnDisk()(file) : std::optional(found->second);
    };
    quintet::writeFile(output_, check::sarifText(all, suppressed_, sources, QUINTET_VERSION, complete));
  } catch (const Error& error) {
    fileFailed_ = true;
    note(error.what());
  }
}

}  // namespace quintet::layer
