#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <tsl/robin_map.h>
#include <tsl/robin_set.h>

#include "objdb/history.h"
#include "objdb/object.h"
#include "objdb/scene/scene.h"
#include "objdb/type.h"

namespace objdb {

/// The world: typed objects by hierarchical path. The dialog manager keeps one; every manipulator mirrors the part that
/// it reads in another. One thread. All checks come before any effect; the effects of a group of calls can be taken
/// back through its history.
class Database : public Names {
 public:
  Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  const Schema& schema() const { return schema_; }
  Result<const Type*> declare_type(Words words) { return schema_.declare_type(words); }
  /// Declares a field; objects that exist get its default.
  Result<const Field*> declare_field(Words words);

  // -- looking

  /// The object at a path, null when there is none.
  const Object* find(std::string_view path) const;
  /// The object of a number, null for 0 and for deleted ones.
  const Object* object(ObjectId id) const { return id < objects_.size() ? objects_[id].get() : nullptr; }
  Result<ObjectId> object(const Word& word, const Type* type) const override;
  std::string_view path(ObjectId id) const override;
  /// How many objects there are.
  std::size_t size() const { return index_.size(); }
  /// Calls `visit` for every object that fits the pattern, in order of creation.
  void for_each(std::string_view pattern, const std::function<void(const Object&)>& visit) const;
  /// Every object of `type` and its subtypes, in order of creation.
  std::vector<const Object*> objects_of(const Type& type) const;

  /// The value of a field; derived ones are computed.
  Value value(const Object& object, int field) const;
  /// Typed look at a field by name; T is a type of Value. The field must exist and be of that kind.
  template <class T>
  const T& get(const Object& object, std::string_view field) const {
    return std::get<T>(object.value(object.type->find(field)));
  }

  scene::Scene& scene() const { return *scene_; }

  // -- changing

  /// Who the next changes come from.
  void speak_as(const Origin& origin) { origin_ = origin; }
  const Origin& origin() const { return origin_; }

  /// Errors: syntax (no path), exists, unknown (what is above it).
  Result<ObjectId> create(const Type& type, std::string_view path);
  /// Can this value be written there? Errors: type, range, unknown.
  Status check(const Object& object, int field, const Value& value) const;
  /// Writes a value that check() accepts. Writing the same bits again is no change, though the origin is renewed.
  void assign(const Object& object, int field, Value&& value);
  void assign(const Object& object, int field, const Value& value) { assign(object, field, Value(value)); }
  /// check() and assign().
  Status set(const Object& object, int field, Value value);
  /// Deletes these objects and everything below them. Refused (busy) while others refer to them, unless `force`,
  /// which empties those references (and the parents of nodes that would else be carried by themselves). Cost in
  /// proportion to what goes; in proportion to the world when others refer to it.
  Status erase(const std::vector<ObjectId>& ids, bool force);
  void set_owner(const Object& object, int field, std::uint16_t owner);

  // -- history: what happened, to be taken back

  /// Keeps at most `limit` changes; 0 keeps none (the default: a mirror takes nothing back).
  void keep_history(std::size_t limit);
  /// Nothing before `mark` can be taken back any more.
  void forget_history(std::uint64_t mark);
  /// A point to return to.
  std::uint64_t mark() const { return history_base_ + history_.size(); }
  /// The oldest point that can still be returned to.
  std::uint64_t oldest_mark() const { return history_base_; }
  /// Values that are assigned while this is set cannot be taken back, and stay when what came before them is.
  void assign_beneath(bool beneath) { beneath_ = beneath; }
  /// Nothing that happened so far will be taken back.
  void forget_history() { forget_history(mark()); }
  /// Takes back everything since `mark`. The inverse is appended to `redo` when given.
  struct Change;
  void roll_back(std::uint64_t mark, std::vector<Change>* redo = nullptr);
  /// Applies what roll_back stored, as new changes.
  void roll_forward(std::vector<Change>& redo);

  // -- what changed

  /// One thing that changed. `field` >= 0: its value; created, deleted: the object.
  struct Event {
    static constexpr int created = -1, deleted = -2;
    std::uint64_t number = 0;
    ObjectId object = 0;
    int field = 0;
  };
  using FeedId = std::size_t;
  /// A reader of changes, from now on.
  FeedId subscribe();
  void unsubscribe(FeedId id);
  /// Every change since the last call, coalesced, in an order in which another database can follow line by line:
  /// deletions of objects whose path was given to another one, creations and plain values as they happened,
  /// references, those of node.parent from the top of the tree of frames down, all other deletions (children first).
  /// A value that changed twice is visited once. A creation speaks for every value that append_create() says;
  /// references and long arrays (Field::said_later) of the new object follow, each as a value. What was created and
  /// deleted, or deleted and brought back by roll_back, since the last call is neither created nor deleted here. For
  /// deleted objects `object` is the object as it was. A derived value is visited when it changes after somebody looked
  /// at it. `visit` must not change the database. Cost in proportion to the changes.
  void read_feed(FeedId id, const std::function<void(const Event&, const Object&)>& visit);
  bool has_events(FeedId id) const;

  /// 64 bits over every object and every value that is part of the world's state (Field::hashed). Independent of the
  /// order of creation; the cost is in proportion to what changed since the last call.
  std::uint64_t hash();

  /// One change of the history, with what was there before.
  struct Change {
    enum class What : std::uint8_t { value, creation, deletion } what;
    std::uint16_t owner = 0;
    int field = 0;
    ObjectId id = 0;
    Value old;
    Origin origin;
    std::shared_ptr<Object> object;  ///< of deletions
  };

 private:
  friend class scene::Scene;

  Object* mutable_object(ObjectId id) { return id < objects_.size() ? objects_[id].get() : nullptr; }
  void derived_changed(Object& object, int field);
  void insert(std::shared_ptr<Object> object);
  std::shared_ptr<Object> remove(ObjectId id);
  void write(Object& object, int field, Value& value, const Origin& origin);
  void count_references(const Field& field, const Value& value, int step);
  void empty_parent(const Object& object);
  Status drop_referrers(const tsl::robin_set<ObjectId>& doomed, bool force);
  void touch(Object& object, int field);
  void touch_hash(Object& object);
  Change& record(Change::What what, ObjectId id);
  void drop_change(Change& change);
  void trim_history();
  void trim_events();
  std::uint64_t push_event(ObjectId id, int field);
  std::uint64_t compute_hash(const Object& object) const;

  Schema schema_;
  std::vector<std::shared_ptr<Object>> objects_;  // by id; null: deleted
  // objects by their path
  struct PathHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view path) const { return hash_text(path); }
    std::size_t operator()(const Object* object) const { return object->path_hash; }
  };
  struct SamePath {
    using is_transparent = void;
    bool operator()(const Object* a, const Object* b) const { return a == b; }
    bool operator()(const Object* a, std::string_view path) const { return a->path == path; }
    bool operator()(std::string_view path, const Object* a) const { return a->path == path; }
  };
  tsl::robin_set<const Object*, PathHash, SamePath, std::allocator<const Object*>, true> index_;
  std::unique_ptr<scene::Scene> scene_;
  Origin origin_;

  History<Change> history_;
  std::uint64_t history_base_ = 0;
  std::size_t history_limit_ = 0;
  bool beneath_ = false;

  struct Feed {
    bool open = false;
    std::uint64_t next = 0;
  };
  std::vector<Feed> feeds_;
  std::size_t open_feeds_ = 0;
  std::deque<Event> events_;
  std::uint64_t event_base_ = 1;     // number of events_.front()
  std::uint64_t furthest_read_ = 1;  // no feed has read this event or a later one
  struct Deleted {
    std::shared_ptr<Object> object;
    std::uint64_t created_event;  // of the life that ended: an undone deletion gives it another
  };
  tsl::robin_map<std::uint64_t, Deleted> deleted_;  // by number of the event

  // deletions that a feed must be told of
  struct Deaths {
    std::vector<std::uint64_t> early, late;  // numbers of their events
    tsl::robin_set<ObjectId> undone;         // known to the feed, deleted and brought back
  };
  Deaths deaths(std::uint64_t first, std::uint64_t end) const;

  std::vector<ObjectId> stale_;
  std::uint64_t hash_ = 0;
};

}  // namespace objdb
