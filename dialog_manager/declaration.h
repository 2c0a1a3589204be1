#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "objdb/database.h"

namespace manager {

/// What a program declared before it said `ready`: what it brings, reads and writes, how often and how long it takes,
/// and what it can do beyond text.
class Declaration {
 public:
  /// What happens to the world when the program cannot be kept alive.
  enum class Policy { stop, hold, skip };
  struct Access {
    std::string type, field;  ///< field empty: all of the type
    bool delayed = false;
  };
  struct Verb {
    std::string name, syntax, doc;
  };

  /// Takes one line; types and fields go into the world. Errors: syntax, unknown, type, unit, range, exists.
  objdb::Status take(objdb::Words words, objdb::Database& world);

  const std::vector<Access>& reads() const { return reads_; }
  const std::vector<Access>& writes() const { return writes_; }
  const std::vector<Verb>& verbs() const { return verbs_; }
  double rate() const { return rate_; }  ///< Hz, 0: every tick
  std::chrono::milliseconds timeout() const { return timeout_; }
  Policy policy() const { return policy_; }
  /// It takes and gives long arrays in shared memory.
  bool shares_arrays() const { return arrays_; }
  /// On `checkpoint` it writes all that it must remember into private fields.
  bool checkpoints() const { return checkpoint_; }

  /// Is this one of its own types, or below one?
  bool brought(const objdb::Type& type) const;
  /// Did it declare this very type; this very field?
  bool declared(const objdb::Type& type) const;
  bool declared(const objdb::Field& field) const;
  /// Does it read (write) this field? `delayed` (may be null): as it was at the end of the tick before.
  bool reads(const objdb::Schema& schema, const objdb::Field& field, bool* delayed) const;
  bool writes(const objdb::Schema& schema, const objdb::Field& field) const;
  /// Does it name a field of this name in its reads?
  bool reads_by_name(const objdb::Field& field, bool* delayed) const;

 private:
  objdb::Status take_access(objdb::Words words, objdb::Database& world);

  std::vector<Access> reads_, writes_;
  std::vector<Verb> verbs_;
  std::vector<const objdb::Type*> types_;
  std::vector<const objdb::Field*> fields_;
  double rate_ = 0;
  std::chrono::milliseconds timeout_{2000};
  Policy policy_ = Policy::stop;
  bool arrays_ = false, checkpoint_ = false;
};

}  // namespace manager
