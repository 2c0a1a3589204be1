#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "dialog_manager/array_memory.h"
#include "dialog_manager/tale.h"
#include "objdb/database.h"

namespace manager {

/// Arrays from this many numbers on are handed over in shared memory and kept as they are in what is told again;
/// shorter ones are quicker as text.
constexpr std::size_t long_array = 1024;

/// Does this value travel by reference?
bool is_long(const objdb::Value& value);

/// Which arrays of the world stand, as they are now, in shared memory: so that readers need only be told where.
class SharedArrays {
 public:
  struct Announced {
    std::shared_ptr<ArrayMemory> memory;
    std::uint64_t sequence = 0;
    std::uint64_t line = 0;  // number of the line that announced it
  };

  /// What a field holds since the present line is what this memory holds.
  void announce(const objdb::Object& object, int field, std::shared_ptr<ArrayMemory> memory, std::uint64_t sequence);
  /// Null when something else was written since.
  const Announced* announced(const objdb::Object& object, int field) const;
  /// A copy of what the field holds; the same for all who ask for it before it changes.
  std::shared_ptr<const Frame> frame(const objdb::Object& object, int field);
  /// Forgets arrays of objects that are gone.
  void forget_dead(const objdb::Database& world);

 private:
  struct Copy {
    objdb::Origin origin;
    std::uint64_t event = 0;
    std::shared_ptr<const Frame> frame;
  };
  std::map<std::pair<objdb::ObjectId, int>, Announced> announced_;
  std::map<std::pair<objdb::ObjectId, int>, Copy> copies_;
};

}  // namespace manager
