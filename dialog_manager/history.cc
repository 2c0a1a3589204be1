#include "dialog_manager/history.h"

#include <string>

namespace manager {
namespace {

using namespace objdb;

// changes; a transaction and the latest command may be longer
constexpr std::size_t undo_limit = 1 << 16;

const Error no_transaction{ErrorKind::unknown, "no transaction is open, expected begin first", 0};

}  // namespace

Status History::begin(const Session& session) {
  if (in_transaction()) return Error{ErrorKind::busy, "a transaction is open already", 0};
  transaction_ = &session;
  transaction_mark_ = world_.mark();
  return {};
}

Status History::commit(const Session& session) {
  if (!in_transaction_of(session)) return no_transaction;
  transaction_ = nullptr;
  if (world_.mark() != transaction_mark_) remember(transaction_mark_);
  return {};
}

Status History::roll_back(const Session& session) {
  if (!in_transaction_of(session)) return no_transaction;
  roll_back_open();
  return {};
}

void History::roll_back_open() {
  if (!in_transaction()) return;
  transaction_ = nullptr;
  world_.roll_back(transaction_mark_);
}

void History::remember(std::uint64_t mark) {
  redo_.clear();
  undo_marks_.push_back(mark);
  if (world_.mark() - world_.oldest_mark() <= undo_limit) return;
  while (undo_marks_.size() > 1 && world_.mark() - undo_marks_.front() > undo_limit) undo_marks_.pop_front();
  world_.forget_history(undo_marks_.front());
}

Status History::undo(std::size_t count) {
  if (count > undo_marks_.size())
    return Error{ErrorKind::limit,
                 "cannot take back " + std::to_string(count) + " commands, there are " +
                     std::to_string(undo_marks_.size()) + " since the last tick",
                 0};
  for (std::size_t i = 0; i < count; ++i) {
    redo_.emplace_back();
    world_.roll_back(undo_marks_.back(), &redo_.back());
    undo_marks_.pop_back();
  }
  return {};
}

Status History::redo(std::size_t count) {
  if (count > redo_.size())
    return Error{
        ErrorKind::limit,
        "cannot do " + std::to_string(count) + " commands again, " + std::to_string(redo_.size()) + " were taken back",
        0};
  for (std::size_t i = 0; i < count; ++i) {
    undo_marks_.push_back(world_.mark());
    world_.roll_forward(redo_.back());
    redo_.pop_back();
  }
  return {};
}

void History::forget() {
  undo_marks_.clear();
  redo_.clear();
}

}  // namespace manager
