#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "dialog_manager/declaration.h"
#include "dialog_manager/tale.h"
#include "objdb/database.h"

namespace manager {

/// What a program is told of the world: the part that it reads, first whole, then what changed. It follows the world
/// through a feed of changes; cost in proportion to the changes.
class Briefing {
 public:
  /// `declaration` is what the program declared, `serving` the objects that it is to serve ("" for all).
  Briefing(objdb::Database& world, const Declaration& declaration, std::string serving);
  ~Briefing();
  Briefing(const Briefing&) = delete;
  Briefing& operator=(const Briefing&) = delete;

  /// Its words are known by this number from now on; begins to follow the world, and tells it whole.
  void begin(std::uint16_t reader, Tale& tale);
  bool begun() const { return begun_; }
  /// Follows the world no longer.
  void end();
  /// What changed since the last call. `tick`: the one under way, whose values a delayed read does not see; 0: none.
  void changes(Tale& tale, std::uint64_t tick);
  /// Everything that the program knows of the world, for a program that knows nothing. To be called after changes():
  /// then nothing is held back.
  void whole(Tale& tale);
  /// The values that the program wrote itself and still owns.
  void own(Tale& tale);
  /// It has become the owner of a value.
  void owns(const objdb::Object& object, int field) { owned_.emplace_back(object.id, field); }
  /// Types and fields were added, or the program declared itself anew.
  void schema_changed();

  /// Is the object the program's to serve?
  bool serves(const objdb::Object& object) const;
  bool serves_path(std::string_view path) const { return serving_.empty() || objdb::matches(serving_, path); }
  const std::string& serving() const { return serving_; }

 private:
  struct Interest {                   // per type: which of its fields are told
    std::vector<signed char> fields;  // 0 no, 1 yes, 2 delayed
    bool any = false;
  };
  struct Held {  // a value that a delayed read sees a tick later
    objdb::ObjectId object;
    int field;
    objdb::Value value;
  };

  const Interest& interest(const objdb::Type& type);
  bool wants(const objdb::Object& object, int field);
  bool told(objdb::ObjectId id) const { return id < told_.size() && told_[id] != 0; }
  bool owns_now(const objdb::Object& object, int field) const;
  void meet_type(const objdb::Type& type, Tale& tale);
  void meet_targets(const objdb::Field& field, const objdb::Value& value, Tale& tale);
  void meet(const objdb::Object& object, Tale& tale);
  void introduce(Tale& tale, const std::vector<const objdb::Object*>& objects);
  void say_held(Tale& tale);
  void say(const objdb::Object& object, int field, Tale& tale);
  void say(const objdb::Object& object, const objdb::Field& field, const objdb::Value& value, Tale& tale);

  objdb::Database& world_;
  const Declaration& declaration_;
  std::string serving_;
  std::uint16_t reader_ = 0;
  bool begun_ = false;
  objdb::Database::FeedId feed_ = 0;

  std::vector<std::uint32_t> told_;  // by object: in which order they were told, 0 for never
  std::uint32_t count_told_ = 0;
  std::vector<const objdb::Type*> told_types_;  // in the order in which they were told
  std::unordered_set<const objdb::Field*> told_fields_;
  std::unordered_map<const objdb::Type*, std::size_t> met_;     // how many fields of a type were looked at
  std::unordered_map<const objdb::Type*, Interest> interests_;  // whose values stay where they are as it grows
  bool new_fields_ = false;
  std::vector<const objdb::Object*> fresh_;  // met, not yet told
  std::vector<Held> held_;
  std::vector<std::pair<objdb::ObjectId, int>> owned_;
};

}  // namespace manager
