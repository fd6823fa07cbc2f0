// SPDX-License-Identifier: Apache-2.0
#include "lab/page.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/text.h"
#include "lab/project_folder.h"

namespace quintet::lab {
namespace {

constexpr std::string_view kNonce = "__CSP_NONCE__";

constexpr std::string_view kMissingPage = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Quintet lab</title>
<body>
<h1>The page of the lab is not built</h1>
<p>When this program was built, Node.js 18 or npm was missing, or npm could not download the packages of the page. To build
it, run these commands in the folder of Quintet, with a network:</p>
<pre>bash scripts/setup.sh page
cmake --preset release
cmake --build --preset release</pre>
<p>The server itself works; docs/design/lab-protocol.md describes its interface.</p>
</body>
</html>
)";

}  // namespace

std::string_view contentType(std::string_view name) {
  constexpr std::pair<std::string_view, std::string_view> kTypes[] = {
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".jpeg", "image/jpeg"},
      {".webp", "image/webp"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".wasm", "application/wasm"},
      {".zip", "application/zip"},
      {".map", "application/json"},
  };
  const std::string lower = lowerCase(name);
  for (const auto& [extension, type] : kTypes)
    if (lower.ends_with(extension)) return type;
  constexpr std::string_view kTexts[] = {".glsl",  ".rgen", ".rchit", ".rahit", ".rint", ".rmiss",
                                         ".rcall", ".toml", ".md",    ".txt",   ".gltf", ".csv"};
  for (const std::string_view extension : kTexts)
    if (lower.ends_with(extension)) return "text/plain; charset=utf-8";
  return "application/octet-stream";
}

void addSecurityHeaders(HttpResponse& response, const std::string& host, const std::string& nonce) {
  constexpr std::string_view kDataPolicy =
      "default-src 'none'; style-src 'unsafe-inline'; sandbox; base-uri 'none'; form-action 'none'; "
      "frame-ancestors 'none'";
  response.headers.emplace_back(
      "Content-Security-Policy",
      nonce.empty()
          ? std::string(kDataPolicy)
          : fmt::format(
                "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{}'; img-src 'self' data: blob:; "
                "media-src 'self' blob:; font-src 'self'; connect-src 'self' ws://{}; worker-src 'self' blob:; "
                "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
                nonce, host));
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("Referrer-Policy", "no-referrer");
  response.headers.emplace_back("Cross-Origin-Opener-Policy", "same-origin");
  response.headers.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
}

const EmbeddedFile* Page::find(std::string_view path) const {
  const auto found = std::ranges::find(files_, path, &EmbeddedFile::path);
  return found == files_.end() ? nullptr : &*found;
}

HttpResponse Page::get(const std::string& path, const std::string& etag, const std::string& nonce) const {
  const bool isIndex = path == "/" || path == "/index.html";
  if (isIndex) {
    const EmbeddedFile* index = find("index.html");
    std::string text(index ? index->data : kMissingPage);
    for (std::size_t at = text.find(kNonce); at != text.npos; at = text.find(kNonce, at + nonce.size()))
      text.replace(at, kNonce.size(), nonce);
    return {.type = "text/html; charset=utf-8", .body = std::move(text), .headers = {{"Cache-Control", "no-store"}}};
  }
  const EmbeddedFile* file = find(std::string_view(path).substr(1));
  if (!file) return errorResponse(404, "this page does not exist");
  const std::string tag = fmt::format("\"{}\"", contentHash(file->data));
  HttpResponse response{.type = std::string(contentType(path)),
                        .headers = {{"Cache-Control", "no-cache"}, {"ETag", tag}}};
  if (etag == tag)
    response.status = 304;
  else
    response.body = file->data;
  return response;
}

}  // namespace quintet::lab
