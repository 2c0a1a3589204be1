#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "objdb/database.h"

namespace manager {

class Session;

/// What can be taken back: the commands since the last tick, and the transaction that is open. One session at a time
/// has one.
class History {
 public:
  explicit History(objdb::Database& world) : world_(world) {}

  // -- transactions. Errors: busy, unknown.
  objdb::Status begin(const Session& session);
  objdb::Status commit(const Session& session);
  objdb::Status roll_back(const Session& session);
  /// Takes back what stands open, whoever began it.
  void roll_back_open();
  bool in_transaction() const { return transaction_ != nullptr; }
  bool in_transaction_of(const Session& session) const { return transaction_ == &session; }
  /// Another session's transaction is open.
  bool busy_for(const Session& session) const { return in_transaction() && !in_transaction_of(session); }

  // -- commands
  /// A command changed the world since this mark of it: it can be taken back, the latest one whatever its size.
  void remember(std::uint64_t mark);
  /// Takes back (does again) so many commands. Error limit.
  objdb::Status undo(std::size_t count);
  objdb::Status redo(std::size_t count);
  /// What was done before cannot be taken back, nor done again, in another time.
  void forget();

 private:
  objdb::Database& world_;
  const Session* transaction_ = nullptr;
  std::uint64_t transaction_mark_ = 0;
  std::deque<std::uint64_t> undo_marks_;
  std::vector<std::vector<objdb::Database::Change>> redo_;
};

}  // namespace manager
