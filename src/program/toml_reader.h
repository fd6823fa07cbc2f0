// Typed access to one table of a TOML file: it knows where it is, names the line of what is wrong, and
// refuses keys that nobody asked for. Every problem is a FileError at "line N".
#ifndef QUINTET_PROGRAM_TOML_READER_H
#define QUINTET_PROGRAM_TOML_READER_H

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "base/toml.h"

namespace quintet::program {

class TomlReader {
 public:
  // `what`: the table's name in messages, "[[ray]]". `file` is kept by reference.
  TomlReader(const toml::table& table, std::string what, const std::string& file);

  const toml::table& table() const { return table_; }
  const std::string& what() const { return what_; }

  // At the node's line; null: the table's.
  [[noreturn]] void fail(const toml::node* node, const std::string& problem) const;
  int line(const toml::node* node = nullptr) const;

  // The value of a key, which is known from now on; null: absent.
  const toml::node* find(const std::string& key);
  // The same, and an error if it is absent.
  const toml::node& need(const std::string& key);

  // Absent: empty, or the fallback.
  std::string text(const std::string& key);
  std::string neededText(const std::string& key);
  std::vector<std::string> texts(const std::string& key);  // a string or a list of strings, none empty
  bool flag(const std::string& key, bool fallback);
  std::uint32_t count(const std::string& key, std::uint32_t low, std::uint32_t high, std::uint32_t fallback);
  double number(const std::string& key, double fallback);
  // The position of the text in `choices`.
  std::size_t choice(const std::string& key, const std::vector<std::string>& choices, std::size_t fallback);

  // A table that is a value of this one; null: absent. `example` is shown if it is something else.
  const toml::table* inlineTable(const std::string& key, const std::string& example);
  // The tables of [[key]]; empty if absent.
  std::vector<const toml::table*> tables(const std::string& key);

  // An error for the first key that nobody asked for, with the nearest that is known.
  void refuseOthers() const;

 private:
  const toml::table& table_;
  std::string what_;
  const std::string& file_;
  std::set<std::string> known_;
};

// "; did you mean 'x'?", or the fallback if no candidate is near.
std::string didYouMean(const std::string& name, const std::vector<std::string>& candidates,
                       const std::string& fallback = {});

}  // namespace quintet::program
#endif
