#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "objdb/result.h"

namespace manager {

/// Commands that were forwarded to a program, by number, and its replies.
class Requests {
 public:
  struct Reply {
    std::string body;  ///< lines with their newlines
    objdb::Status status;
  };

  /// A command is sent: its number.
  std::uint64_t add();
  /// It was sent under this number, in an earlier life of the manager.
  void added_before(std::uint64_t number) { next_ = number + 1; }
  /// Was a command of this number ever sent?
  bool known(std::uint64_t number) const { return number < next_; }
  /// Commands that wait for a reply.
  std::size_t waiting() const;

  /// A line of a reply's body, without its two blanks; what came of it so far is dropped.
  void body(std::string_view line) { body_.append(line).append("\n"); }
  void drop_body() { body_.clear(); }
  /// "@7 ok" or "@7 error KIND COLUMN sentence". False: no command waits for that.
  bool close(std::string_view line);
  /// No more replies will come.
  void fail(const objdb::Error& error);

  /// Is the reply to this command waited for, or there to be taken?
  bool has(std::uint64_t number) const;
  /// The reply to a command that it has, once; nothing while it is waited for.
  std::optional<Reply> take(std::uint64_t number);

 private:
  std::uint64_t next_ = 1;
  std::vector<std::pair<std::uint64_t, std::optional<Reply>>> sent_;
  std::string body_;
};

/// The number of "@7 ok", nothing when there is none.
std::optional<std::uint64_t> request_number(std::string_view line);

}  // namespace manager
