#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "objdb/scene/transform.h"
#include "objdb/type.h"
#include "objdb/value.h"

namespace objdb {

/// Who wrote a value, at which tick, by which accepted line (a number that the manager gives out).
struct Origin {
  std::uint64_t line = 0;
  std::uint32_t tick = 0;
  std::uint16_t source = 0;
};

/// A value in its place: one cache line, so that one write in a large world waits for memory once.
struct alignas(64) Slot {
  Value value;
  Origin origin;                 ///< of the latest write
  std::uint64_t event : 48 = 0;  ///< number of the latest change event of this slot
  std::uint64_t owner : 16 = 0;  ///< the program that alone may write it, 0: nobody yet
};
static_assert(sizeof(Slot) == 64);

/// Place of a node in the tree of frames; kept by Scene.
struct Place {
  ObjectId parent = 0;
  std::vector<ObjectId> children;
  scene::Transform world;
  bool current = false;  ///< world is up to date
};

/// An object of the world. Read freely; only Database writes.
struct alignas(64) Object {
  // what a write needs stands first, in one cache line
  std::string path;
  const Type* type = nullptr;
  std::vector<Slot> slots;       ///< one a field of the type
  std::unique_ptr<Place> place;  ///< of nodes
  ObjectId id = 0;
  ObjectId parent = 0;  ///< by path, 0 at the top
  bool hash_stale = true;
  std::vector<ObjectId> children;  ///< by path, in order of creation
  std::uint64_t path_hash = 0;
  std::uint64_t hash = 0;       ///< contribution to the world's hash, as last computed
  std::uint32_t referrers = 0;  ///< how many ref values point here
  std::uint64_t created_event = 0;

  const Value& value(int field) const { return slots[static_cast<std::size_t>(field)].value; }
  bool is_default(int field) const { return same_bits(value(field), type->field(field).standard); }
  /// The last name of the path.
  std::string_view name() const { return std::string_view(path).substr(path.rfind('/') + 1); }
};

}  // namespace objdb
