// SPDX-License-Identifier: Apache-2.0
// The files of the page (web/dist), which are embedded if they existed when Quintet was built, and the headers that keep
// everything else out of the page.
#ifndef QUINTET_LAB_PAGE_H
#define QUINTET_LAB_PAGE_H

#include <span>
#include <string>
#include <string_view>

#include "base/embedded.h"
#include "lab/http_message.h"

namespace quintet::lab {

// By the extension: "text/javascript; charset=utf-8". Unknown ones are bytes.
std::string_view contentType(std::string_view name);

// Adds the headers of all answers: Content-Security-Policy and others. `host`: as the request states it. `nonce`: of the page;
// empty for data, which never run as a page, even if a browser opens their URL.
void addSecurityHeaders(HttpResponse& response, const std::string& host, const std::string& nonce);

class Page {
 public:
  // Without an index.html, `/` explains how to build the page.
  explicit Page(std::span<const EmbeddedFile> files) : files_(files) {}

  // The answer to GET of a path such as "/" or "/assets/index.js"; 404 for other names. `etag`: of If-None-Match.
  HttpResponse get(const std::string& path, const std::string& etag, const std::string& nonce) const;

 private:
  const EmbeddedFile* find(std::string_view path) const;

  std::span<const EmbeddedFile> files_;
};

}  // namespace quintet::lab
#endif
