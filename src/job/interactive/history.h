// SPDX-License-Identifier: Apache-2.0
// Undo and redo of a value: each step has a name, and stores a copy of the value before it. A step of the same group as the
// step before it extends that step.
#ifndef QUINTET_JOB_INTERACTIVE_HISTORY_H
#define QUINTET_JOB_INTERACTIVE_HISTORY_H

#include <string>
#include <utility>
#include <vector>

namespace quintet::job::interactive {

template <class Value>
class History {
 public:
  // `before`: the value before the step. An empty group extends nothing. `name`: for the user, "move of 'Lamp'".
  void add(Value before, const std::string& group, const std::string& name = {}) {
    redo_.clear();
    const bool extends = !group.empty() && group == group_;
    group_ = group;
    if (!extends) undo_.push_back({std::move(before), name});
  }
  // The next step is a new one.
  void endGroup() { group_.clear(); }

  bool canUndo() const { return !undo_.empty(); }
  bool canRedo() const { return !redo_.empty(); }
  // Names of the steps of undone() and redone(); empty if there is none.
  std::string undoName() const { return canUndo() ? undo_.back().name : std::string(); }
  std::string redoName() const { return canRedo() ? redo_.back().name : std::string(); }
  // The value to which undo() or redo() leads.
  const Value& undone() const { return undo_.back().value; }
  const Value& redone() const { return redo_.back().value; }
  // Removes the step of undone() or redone(), which cannot be shown.
  void dropUndo() { drop(undo_); }
  void dropRedo() { drop(redo_); }
  // `current`: the value until now.
  void undo(Value current) { move(undo_, redo_, std::move(current)); }
  void redo(Value current) { move(redo_, undo_, std::move(current)); }

 private:
  struct Step {
    Value value;
    std::string name;
  };

  void move(std::vector<Step>& from, std::vector<Step>& to, Value current) {
    to.push_back({std::move(current), std::move(from.back().name)});
    drop(from);
  }
  void drop(std::vector<Step>& steps) {
    steps.pop_back();
    endGroup();
  }

  std::vector<Step> undo_, redo_;  // the next one is last
  std::string group_;
};

}  // namespace quintet::job::interactive
#endif
