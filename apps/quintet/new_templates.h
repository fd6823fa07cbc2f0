// The programs that `quintet new` begins with: relative path -> text.
#ifndef QUINTET_APP_NEW_TEMPLATES_H
#define QUINTET_APP_NEW_TEMPLATES_H

#include <map>
#include <string>

namespace quintet::app {

// One file, the lecture form; `file` is its name.
std::map<std::string, std::string> lectureTemplate(const std::string& file);
std::map<std::string, std::string> folderTemplate();

}  // namespace quintet::app
#endif
