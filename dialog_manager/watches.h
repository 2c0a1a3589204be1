#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "objdb/database.h"
#include "objdb/statement.h"

namespace manager {

class Session;

/// Who is told what changes: `watch PATTERN`. Cost in proportion to the changes; none while nobody watches.
class Watches {
 public:
  explicit Watches(objdb::Database& world) : world_(world) {}

  void add(Session& session, std::string pattern, objdb::Scope scope);
  /// This session watches no longer.
  void remove(const Session& session);
  /// Tells what changed since the last call. `behind`: nobody reads what is told; then what was held back stays so.
  void tell(bool behind);
  /// Changes wait to be told until somebody reads again.
  bool held() const { return !held_.empty(); }

 private:
  struct Watch {
    Session* session;
    std::string pattern;
    objdb::Scope scope;
  };
  void tell(const objdb::Object& object, int field);
  void tell_value(const Watch& watch, const objdb::Object& object, int field, std::string_view wanted);

  objdb::Database& world_;
  std::vector<Watch> watches_;
  std::optional<objdb::Database::FeedId> feed_;
  std::set<std::pair<objdb::ObjectId, int>> held_;  // changes that nobody read in time: told at their newest
};

}  // namespace manager
