#include "objdb/database.h"

#include <algorithm>
#include <bit>

namespace objdb {
namespace {

std::string_view parent_path(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? std::string_view() : path.substr(0, slash);
}

template <class F>
void for_each_reference(const Value& value, F visit) {
  if (const auto* one = std::get_if<std::int64_t>(&value)) visit(static_cast<ObjectId>(*one));
  if (const auto* many = std::get_if<std::vector<std::int64_t>>(&value))
    for (const std::int64_t each : *many) visit(static_cast<ObjectId>(each));
}

void drop_references(Value& value, const tsl::robin_set<ObjectId>& doomed) {
  const auto drop = [&](std::int64_t& id) {
    if (doomed.contains(static_cast<ObjectId>(id))) id = 0;
  };
  if (auto* one = std::get_if<std::int64_t>(&value)) drop(*one);
  if (auto* many = std::get_if<std::vector<std::int64_t>>(&value))
    for (std::int64_t& each : *many) drop(each);
}

}  // namespace

Database::Database() : objects_(1), scene_(std::make_unique<scene::Scene>(*this)) {}

Result<const Field*> Database::declare_field(Words words) {
  const Result<Schema::Declared> declared = schema_.declare_field(words);
  if (!declared) return declared.error();
  const Field& field = *declared->field;
  if (declared->fresh) {
    for (const auto& object : objects_) {
      if (!object || !object->type->is(*field.owner)) continue;
      Slot& slot = object->slots.emplace_back();
      slot.value = field.standard;
      slot.origin = origin_;
      touch(*object, static_cast<int>(object->slots.size()) - 1);
      touch_hash(*object);
    }
  }
  return &field;
}

const Object* Database::find(std::string_view path) const {
  const auto found = index_.find(path);
  return found == index_.end() ? nullptr : *found;
}

Result<ObjectId> Database::object(const Word& word, const Type* type) const {
  const Object* found = find(word.text);
  if (found == nullptr) {
    if (!is_path(word.text))
      return Error{ErrorKind::syntax, shown(word.text) + " is not a path (names joined by '/')", word.column};
    std::vector<std::string_view> paths;
    // a hint is worth a look at a small world only
    if (index_.size() <= 10'000)
      for (const auto& each : objects_)
        if (each) paths.push_back(each->path);
    return Error{ErrorKind::unknown, "no object " + shown(word.text) + did_you_mean(word.text, paths), word.column};
  }
  if (type != nullptr && !found->type->is(*type))
    return Error{ErrorKind::type, found->path + " is a " + found->type->name() + ", expected a " + type->name(),
                 word.column};
  return found->id;
}

std::string_view Database::path(ObjectId id) const {
  const Object* found = object(id);
  return found == nullptr ? std::string_view("-") : std::string_view(found->path);
}

void Database::for_each(std::string_view pattern, const std::function<void(const Object&)>& visit) const {
  if (!is_pattern(pattern)) {
    if (const Object* one = find(pattern)) visit(*one);
    return;
  }
  for (const auto& object : objects_)
    if (object && matches(pattern, object->path)) visit(*object);
}

std::vector<const Object*> Database::objects_of(const Type& type) const {
  std::vector<const Object*> out;
  for (const auto& object : objects_)
    if (object && object->type->is(type)) out.push_back(object.get());
  return out;
}

Value Database::value(const Object& object, int field) const {
  if (!object.type->field(field).derived) return object.value(field);
  const scene::Transform& world = scene_->world(object);
  if (field == scene::Scene::world_position) return world.p;
  return scene::quaternion(world);
}

Result<ObjectId> Database::create(const Type& type, std::string_view path) {
  if (!is_path(path)) return Error{ErrorKind::syntax, shown(path) + " is not a path (names joined by '/')", 0};
  if (path.size() > longest_path)
    return Error{ErrorKind::limit,
                 shown(path) + " has " + std::to_string(path.size()) + " bytes, expected at most " +
                     std::to_string(longest_path),
                 0};
  if (index_.find(path) != index_.end())
    return Error{ErrorKind::exists, "object " + shown(path) + " is there already", 0};
  const std::string_view above = parent_path(path);
  const Object* parent = nullptr;
  if (!above.empty()) {
    parent = find(above);
    if (parent == nullptr)
      return Error{ErrorKind::unknown, shown(path) + " needs " + shown(above) + ", which is not there", 0};
  }

  auto object = std::make_shared<Object>();
  object->id = static_cast<ObjectId>(objects_.size());
  object->type = &type;
  object->path = path;
  object->path_hash = hash_text(path);
  object->parent = parent == nullptr ? 0 : parent->id;
  object->slots.resize(type.fields().size());
  for (std::size_t i = 0; i < object->slots.size(); ++i) {
    object->slots[i].value = type.fields()[i]->standard;
    object->slots[i].origin = origin_;
  }
  const ObjectId id = object->id;
  objects_.emplace_back();
  insert(std::move(object));
  if (history_limit_ > 0) record(Change::What::creation, id);
  return id;
}

void Database::insert(std::shared_ptr<Object> object) {
  Object& inserted = *object;
  // fields may have been declared while it was deleted
  for (std::size_t i = inserted.slots.size(); i < inserted.type->fields().size(); ++i) {
    inserted.slots.emplace_back().value = inserted.type->fields()[i]->standard;
    touch(inserted, static_cast<int>(i));
  }
  objects_[inserted.id] = std::move(object);
  index_.insert(&inserted);
  if (Object* parent = mutable_object(inserted.parent)) scene::insert_id(parent->children, inserted.id);
  for (std::size_t i = 0; i < inserted.slots.size(); ++i)
    if (inserted.type->fields()[i]->holds_refs())
      count_references(*inserted.type->fields()[i], inserted.slots[i].value, 1);
  scene_->created(inserted);
  inserted.created_event = open_feeds_ > 0 ? push_event(inserted.id, Event::created) : 0;
  inserted.hash = 0;
  inserted.hash_stale = false;
  touch_hash(inserted);
}

std::shared_ptr<Object> Database::remove(ObjectId id) {
  std::shared_ptr<Object> object = objects_[id];
  index_.erase(object.get());
  if (Object* parent = mutable_object(object->parent)) scene::erase_id(parent->children, id);
  for (std::size_t i = 0; i < object->slots.size(); ++i)
    if (object->type->fields()[i]->holds_refs())
      count_references(*object->type->fields()[i], object->slots[i].value, -1);
  objects_[id] = nullptr;
  scene_->erased(*object);
  hash_ -= object->hash;
  // what no feed has seen created, no feed is told deleted
  if (open_feeds_ > 0 && object->created_event < furthest_read_)
    deleted_.emplace(push_event(id, Event::deleted), Deleted{object, object->created_event});
  return object;
}

Status Database::check(const Object& object, int field, const Value& value) const {
  const Field& declared = object.type->field(field);
  const std::string where = object.path + ".";
  if (declared.derived)
    return Error{ErrorKind::owner, where + declared.name + " is computed from other fields and cannot be set", 0};
  if (Status status = check_value(declared, value); !status)
    return Error{status.error().kind, where + status.error().sentence, 0};
  if (declared.kind == Kind::ref) {
    Status status;
    for_each_reference(value, [&](ObjectId id) {
      if (id == 0 || !status) return;
      const Object* target = this->object(id);
      if (target == nullptr)
        status = Error{ErrorKind::unknown, where + declared.name + ": no object of number " + std::to_string(id), 0};
      else if (declared.ref_type != nullptr && !target->type->is(*declared.ref_type))
        status = Error{ErrorKind::type,
                       where + declared.name + ": " + target->path + " is a " + target->type->name() + ", expected a " +
                           declared.ref_type->name(),
                       0};
    });
    if (!status) return status;
    if (object.place && field == scene::Scene::parent)
      return scene_->check_parent(object, static_cast<ObjectId>(std::get<std::int64_t>(value)));
  }
  return {};
}

Status Database::set(const Object& object, int field, Value value) {
  if (Status status = check(object, field, value); !status) return status;
  assign(object, field, std::move(value));
  return {};
}

void Database::assign(const Object& object, int field, Value&& value) {
  Object& target = const_cast<Object&>(object);
  Slot& slot = target.slots[static_cast<std::size_t>(field)];
  if (same_bits(slot.value, value)) {
    slot.origin = origin_;
    return;
  }
  const Origin old_origin = slot.origin;
  write(target, field, value, origin_);
  if (history_limit_ == 0 || beneath_) return;
  Change& change = record(Change::What::value, target.id);
  change.owner = static_cast<std::uint16_t>(slot.owner);
  change.field = field;
  change.origin = old_origin;
  // write() has left the old value in `value`
  swap_values(change.old, value);
}

void Database::write(Object& object, int field, Value& value, const Origin& origin) {
  Slot& slot = object.slots[static_cast<std::size_t>(field)];
  const Field& declared = object.type->field(field);
  if (declared.holds_refs()) {
    count_references(declared, slot.value, -1);
    count_references(declared, value, 1);
  }
  swap_values(slot.value, value);
  slot.origin = origin;
  touch(object, field);
  if (declared.hashed()) touch_hash(object);
  if (object.place) scene_->changed(object, field);
}

void Database::set_owner(const Object& object, int field, std::uint16_t owner) {
  objects_[object.id]->slots[static_cast<std::size_t>(field)].owner = owner;
}

void Database::count_references(const Field&, const Value& value, int step) {
  for_each_reference(value, [&](ObjectId id) {
    if (Object* target = mutable_object(id)) target->referrers += static_cast<std::uint32_t>(step);
  });
}

Status Database::erase(const std::vector<ObjectId>& ids, bool force) {
  // everything below goes too
  tsl::robin_set<ObjectId> doomed;
  std::vector<ObjectId> all;
  const auto doom = [&](ObjectId id) {
    if (doomed.insert(id).second) all.push_back(id);
  };
  for (const ObjectId id : ids) doom(id);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const ObjectId child : objects_[all[i]]->children) doom(child);
  std::sort(all.begin(), all.end());

  // references from within do not count
  tsl::robin_map<ObjectId, std::uint32_t> inner;
  for (const ObjectId id : all)
    for (std::size_t i = 0; i < objects_[id]->slots.size(); ++i)
      if (objects_[id]->type->fields()[i]->holds_refs())
        for_each_reference(objects_[id]->slots[i].value, [&](ObjectId to) { ++inner[to]; });
  const bool referred = std::any_of(all.begin(), all.end(), [&](ObjectId id) {
    const std::uint32_t referrers = objects_[id]->referrers;
    return referrers > 0 && referrers > inner[id];
  });
  if (referred)
    if (Status status = drop_referrers(doomed, force); !status) return status;

  // from below: children have larger numbers than their parents
  for (auto id = all.rbegin(); id != all.rend(); ++id) {
    std::shared_ptr<Object> object = remove(*id);
    if (history_limit_ > 0) record(Change::What::deletion, *id).object = std::move(object);
  }
  return {};
}

Status Database::drop_referrers(const tsl::robin_set<ObjectId>& doomed, bool force) {
  for (const auto& other : objects_) {
    if (!other || doomed.contains(other->id)) continue;
    for (std::size_t i = 0; i < other->slots.size(); ++i) {
      const Field& field = *other->type->fields()[i];
      if (!field.holds_refs()) continue;
      ObjectId hit = 0;
      for_each_reference(other->slots[i].value, [&](ObjectId to) {
        if (doomed.contains(to)) hit = to;
      });
      if (hit == 0) continue;
      if (!force)
        return Error{ErrorKind::busy,
                     objects_[hit]->path + " is referred to by " + other->path + "." + field.name +
                         ", expected no reference (or: delete ... force)",
                     0};
      if (other->place && i == scene::Scene::parent) {
        empty_parent(*other);
        continue;
      }
      Value emptied = other->slots[i].value;
      drop_references(emptied, doomed);
      assign(*other, static_cast<int>(i), std::move(emptied));
    }
  }
  return {};
}

void Database::empty_parent(const Object& object) {
  // then the node above it in its path carries it, which it must not carry itself
  while (const Object* first = scene_->in_the_way(object)) empty_parent(*first);
  assign(object, scene::Scene::parent, Value(std::int64_t{0}));
}

Database::Change& Database::record(Change::What what, ObjectId id) {
  trim_history();
  Change& change = history_.push();
  change.what = what;
  change.id = id;
  change.field = 0;
  change.owner = 0;
  change.origin = origin_;
  return change;
}

void Database::drop_change(Change& change) {
  // its place is used again: what it owns goes
  constexpr std::size_t flat = 4;
  if (change.old.index() >= flat) change.old = std::int64_t{0};
  change.object.reset();
}

void Database::keep_history(std::size_t limit) {
  history_limit_ = limit;
  trim_history();
}

void Database::forget_history(std::uint64_t mark) {
  while (history_base_ < mark && !history_.empty()) {
    drop_change(history_.front());
    history_.pop_front();
    ++history_base_;
  }
}

void Database::trim_history() {
  // there is room for one more afterwards
  while (history_.size() >= std::max<std::size_t>(history_limit_, 1)) forget_history(history_base_ + 1);
}

void Database::roll_back(std::uint64_t mark, std::vector<Change>* redo) {
  while (history_base_ + history_.size() > mark && !history_.empty()) {
    Change change = std::move(history_.back());
    drop_change(history_.back());
    history_.pop_back();
    switch (change.what) {
      case Change::What::value: {
        Object& object = *objects_[change.id];
        const Origin origin = object.slots[static_cast<std::size_t>(change.field)].origin;
        write(object, change.field, change.old, change.origin);
        change.origin = origin;
        break;
      }
      case Change::What::creation: change.object = remove(change.id); break;
      case Change::What::deletion: insert(change.object); break;
    }
    if (redo != nullptr) redo->push_back(std::move(change));
  }
}

void Database::roll_forward(std::vector<Change>& redo) {
  while (!redo.empty()) {
    Change change = std::move(redo.back());
    redo.pop_back();
    switch (change.what) {
      case Change::What::value: {
        Object& object = *objects_[change.id];
        const Origin origin = object.slots[static_cast<std::size_t>(change.field)].origin;
        write(object, change.field, change.old, change.origin);
        change.origin = origin;
        break;
      }
      case Change::What::creation:
        insert(std::move(change.object));
        change.object = nullptr;
        break;
      case Change::What::deletion: change.object = remove(change.id); break;
    }
    if (history_limit_ == 0) continue;
    Change& again = record(change.what, change.id);
    again = std::move(change);
  }
}

std::uint64_t Database::push_event(ObjectId id, int field) {
  const std::uint64_t number = event_base_ + events_.size();
  events_.push_back({number, id, field});
  return number;
}

void Database::touch(Object& object, int field) {
  if (open_feeds_ == 0) return;
  Slot& slot = object.slots[static_cast<std::size_t>(field)];
  // an event that nobody has read yet speaks for the new value too
  if (slot.event >= furthest_read_) return;
  slot.event = push_event(object.id, field);
}

void Database::derived_changed(Object& object, int field) { touch(object, field); }

void Database::touch_hash(Object& object) {
  if (object.hash_stale) return;
  object.hash_stale = true;
  stale_.push_back(object.id);
}

Database::FeedId Database::subscribe() {
  std::size_t id = 0;
  while (id < feeds_.size() && feeds_[id].open) ++id;
  if (id == feeds_.size()) feeds_.emplace_back();
  ++open_feeds_;
  feeds_[id] = {true, event_base_ + events_.size()};
  furthest_read_ = feeds_[id].next;
  return id;
}

void Database::unsubscribe(FeedId id) {
  feeds_[id].open = false;
  --open_feeds_;
  trim_events();
}

bool Database::has_events(FeedId id) const { return feeds_[id].next < event_base_ + events_.size(); }

Database::Deaths Database::deaths(std::uint64_t first, std::uint64_t end) const {
  Deaths out;
  if (deleted_.empty()) return out;
  std::vector<std::uint64_t> gone;
  for (std::uint64_t number = first; number < end; ++number) {
    const Event& event = events_[number - event_base_];
    if (event.field != Event::deleted || deleted_.find(number)->second.created_event >= first) continue;
    if (object(event.object) != nullptr)
      out.undone.insert(event.object);
    else
      gone.push_back(number);
  }
  for (const std::uint64_t number : gone) {
    // it must go at once when its path, or that of something above it, was given to another object
    bool reborn = false;
    std::string_view path = deleted_.find(number)->second.object->path;
    for (; !path.empty() && !reborn; path = parent_path(path)) {
      const Object* other = find(path);
      reborn = other != nullptr && other->created_event >= first && !out.undone.contains(other->id);
    }
    (reborn ? out.early : out.late).push_back(number);
  }
  return out;
}

void Database::read_feed(FeedId id, const std::function<void(const Event&, const Object&)>& visit) {
  const std::uint64_t first = feeds_[id].next, end = event_base_ + events_.size();
  furthest_read_ = std::max(furthest_read_, end);
  const Deaths deaths = this->deaths(first, end);
  const auto bury = [&](std::uint64_t number) {
    visit(events_[number - event_base_], *deleted_.find(number)->second.object);
  };
  std::vector<Event> later;
  std::vector<ObjectId> moved;
  const auto visit_later = [&](const Event& event, const Object& object) {
    if (object.place && event.field == scene::Scene::parent)
      moved.push_back(object.id);
    else
      later.push_back(event);
  };

  for (const std::uint64_t number : deaths.early) bury(number);
  for (std::uint64_t number = first; number < end; ++number) {
    const Event event = events_[number - event_base_];
    const Object* object = event.field == Event::deleted ? nullptr : this->object(event.object);
    if (object == nullptr) continue;
    const bool known = object->created_event < first || deaths.undone.contains(object->id);
    if (event.field == Event::created) {
      if (known || object->created_event != number) continue;
      visit(event, *object);
      for (int i = 0; i < static_cast<int>(object->slots.size()); ++i)
        if (object->type->field(i).said_later() && !object->is_default(i))
          visit_later({number, object->id, i}, *object);
    } else if (known && object->slots[static_cast<std::size_t>(event.field)].event == number) {
      if (object->type->field(event.field).holds_refs())
        visit_later(event, *object);
      else
        visit(event, *object);
    }
  }

  for (const Event& event : later) visit(event, *object(event.object));
  // an early deletion may have emptied parents there that were not emptied here
  if (!deaths.early.empty()) moved = scene_->carried_by(moved);
  for (const ObjectId node : scene_->top_down(moved)) {
    const Object& object = *objects_[node];
    visit({object.slots[scene::Scene::parent].event, node, scene::Scene::parent}, object);
  }
  for (const std::uint64_t number : deaths.late) bury(number);
  feeds_[id].next = end;
  trim_events();
}

void Database::trim_events() {
  std::uint64_t least = event_base_ + events_.size();
  for (const Feed& feed : feeds_)
    if (feed.open) least = std::min(least, feed.next);
  while (event_base_ < least) {
    if (events_.front().field == Event::deleted) deleted_.erase(event_base_);
    events_.pop_front();
    ++event_base_;
  }
}

std::uint64_t Database::hash() {
  for (const ObjectId id : stale_) {
    Object* object = mutable_object(id);
    if (object == nullptr || !object->hash_stale) continue;
    // the hash is a sum over objects, so that one object's change costs one object
    hash_ -= object->hash;
    object->hash = compute_hash(*object);
    object->hash_stale = false;
    hash_ += object->hash;
  }
  stale_.clear();
  return hash_;
}

std::uint64_t Database::compute_hash(const Object& object) const {
  std::uint64_t hash = hash_text(object.type->name(), object.path_hash);
  const auto mix = [&](std::uint64_t word) { hash = hash_word(hash, word); };
  const auto mix_integer = [&](const Field& field, std::int64_t value) {
    if (field.kind == Kind::ref)
      mix(value == 0 ? 0 : this->object(static_cast<ObjectId>(value))->path_hash);
    else if (field.kind == Kind::word)
      hash = hash_text(field.words[static_cast<std::size_t>(value)], hash);
    else
      mix(static_cast<std::uint64_t>(value));
  };
  // fields are summed too: a subtype's order of fields depends on the order of declarations
  std::uint64_t sum = hash;
  for (std::size_t i = 0; i < object.slots.size(); ++i) {
    const Field& field = *object.type->fields()[i];
    if (!field.hashed()) continue;
    hash = hash_text(field.name, object.path_hash);
    std::visit(
        [&](const auto& value) {
          using T = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<T, std::int64_t>) {
            mix_integer(field, value);
          } else if constexpr (std::is_same_v<T, double>) {
            mix(std::bit_cast<std::uint64_t>(value));
          } else if constexpr (std::is_same_v<T, std::string>) {
            hash = hash_text(value, hash);
          } else if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, Quat>) {
            for (const double each : value) mix(std::bit_cast<std::uint64_t>(each));
          } else {
            mix(value.size());
            if constexpr (std::is_same_v<T, Numbers>)
              if (value.size() >= long_array) return mix(value.hash());
            for (const auto& each : value) {
              if constexpr (std::is_same_v<T, Numbers>)
                mix(std::bit_cast<std::uint64_t>(each));
              else if constexpr (std::is_same_v<T, std::vector<std::string>>)
                hash = hash_text(each, hash);
              else
                mix_integer(field, each);
            }
          }
        },
        object.slots[i].value);
    sum += hash;
  }
  return sum;
}

}  // namespace objdb
