#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dialog_manager/condition.h"
#include "objdb/statement.h"

namespace manager {

class Manager;
class Session;

/// Commands for later: `at TIME`, `every PERIOD`, `when CONDITION`. They run after a tick, in the order in which they
/// were given, before anyone else speaks.
class Schedule {
 public:
  struct Entry {
    enum class Kind { at, every, when } kind;
    int id = 0;
    double time = 0;  ///< s, of the next run
    double start = 0, period = 0;
    std::uint64_t runs = 0;
    std::optional<Condition> condition;
    bool held = false;  ///< the condition held after the last tick
    std::string command;
    std::string where;  ///< FILE:LINE of the command that gave it
    objdb::Scope scope;
  };

  int add(Entry entry);
  /// Numbers count from 1 again.
  void clear() {
    entries_.clear();
    next_id_ = 1;
  }
  int next_id() const { return next_id_; }
  void number_from(int id) { next_id_ = id; }
  /// Takes up the last entry as it stood in another life: its number, and how far it has come.
  void restore(int id, double start, std::uint64_t runs, bool held);
  /// The command that gives an entry.
  static std::string say(const Entry& entry);
  /// False: no such id.
  bool forget(int id);
  const std::vector<Entry>& entries() const { return entries_; }
  /// Entries that are due at this time, in order; each is given once.
  std::vector<Entry> take_due(double time, const objdb::Database& world);

 private:
  std::vector<Entry> entries_;
  int next_id_ = 1;
};

}  // namespace manager
