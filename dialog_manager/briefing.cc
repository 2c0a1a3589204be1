#include "dialog_manager/briefing.h"

#include <algorithm>

#include "objdb/statement.h"

namespace manager {
namespace {

using namespace objdb;

// every program knows what is built in
bool built_in(const Type& type, const Field* field) {
  static const Schema pristine;
  const Type* known = pristine.find(type.name());
  return known != nullptr && (field == nullptr || known->find(field->name) >= 0);
}

bool is_long(const Value& value) {
  const auto* numbers = std::get_if<Numbers>(&value);
  return numbers != nullptr && numbers->size() >= long_array;
}

// what a reference names may have gone since
void drop_dead(Value& value, const Database& world) {
  const auto drop = [&](std::int64_t& id) {
    if (world.object(static_cast<ObjectId>(id)) == nullptr) id = 0;
  };
  if (auto* one = std::get_if<std::int64_t>(&value)) drop(*one);
  if (auto* many = std::get_if<std::vector<std::int64_t>>(&value))
    for (std::int64_t& each : *many) drop(each);
}

}  // namespace

Briefing::Briefing(Database& world, const Declaration& declaration, std::string serving)
    : world_(world), declaration_(declaration), serving_(std::move(serving)) {}

Briefing::~Briefing() { end(); }

void Briefing::end() {
  if (begun_) world_.unsubscribe(feed_);
  begun_ = false;
}

bool Briefing::serves(const Object& object) const {
  return serving_.empty() || !declaration_.brought(*object.type) || matches(serving_, object.path);
}

void Briefing::schema_changed() {
  interests_.clear();
  new_fields_ = true;
}

const Briefing::Interest& Briefing::interest(const Type& type) {
  Interest& known = interests_[&type];
  if (known.fields.size() == type.fields().size()) return known;
  known.fields.assign(type.fields().size(), 0);
  const bool own = declaration_.brought(type);
  for (std::size_t i = 0; i < known.fields.size(); ++i) {
    const Field& field = *type.fields()[i];
    if (own && !field.derived) known.fields[i] = 1;
    for (const Declaration::Access& access : declaration_.reads()) {
      if (!access.field.empty() && access.field != field.name) continue;
      const Type* read = world_.schema().find(access.type);
      if (read == nullptr || !type.is(*read)) continue;
      if (access.field.empty() && field.derived) continue;
      known.fields[i] = access.delayed ? 2 : 1;
    }
    known.any = known.any || known.fields[i] != 0;
  }
  return known;
}

bool Briefing::wants(const Object& object, int field) {
  return interest(*object.type).fields[static_cast<std::size_t>(field)] != 0;
}

bool Briefing::owns_now(const Object& object, int field) const {
  return object.slots[static_cast<std::size_t>(field)].owner == reader_;
}

// -- the world, whole

void Briefing::begin(std::uint16_t reader, Tale& tale) {
  reader_ = reader;
  feed_ = world_.subscribe();
  begun_ = true;
  interests_.clear();
  world_.for_each("**", [&](const Object& object) {
    if (interest(*object.type).any && serves(object)) meet(object, tale);
  });
  std::sort(fresh_.begin(), fresh_.end(), [](const Object* a, const Object* b) { return a->id < b->id; });
  introduce(tale, fresh_);
  fresh_.clear();
}

void Briefing::meet_type(const Type& type, Tale& tale) {
  const auto [place, fresh] = met_.emplace(&type, 0);
  std::size_t& met = place->second;
  if (met == type.fields().size() && !fresh) return;
  if (type.base() != nullptr) meet_type(*type.base(), tale);
  if (fresh) {
    told_types_.push_back(&type);
    if (!built_in(type, nullptr) && !declaration_.declared(type))
      tale.text += "type " + type.name() + (type.base() == nullptr ? "" : " extends " + type.base()->name()) + "\n";
  }
  const Interest& wanted = interest(type);
  const std::size_t first = met;
  met = type.fields().size();
  for (std::size_t i = first; i < type.fields().size(); ++i) {
    const Field& field = *type.fields()[i];
    if (wanted.fields[i] == 0 || built_in(*field.owner, &field) || declaration_.declared(field) ||
        !told_fields_.insert(&field).second)
      continue;
    if (field.ref_type != nullptr) meet_type(*field.ref_type, tale);
    tale.text += field.declaration() + "\n";
  }
}

void Briefing::meet_targets(const Field& field, const Value& value, Tale& tale) {
  if (!field.holds_refs()) return;
  const auto visit = [&](std::int64_t target) {
    if (const Object* object = world_.object(static_cast<ObjectId>(target))) meet(*object, tale);
  };
  if (const auto* one = std::get_if<std::int64_t>(&value)) visit(*one);
  if (const auto* many = std::get_if<std::vector<std::int64_t>>(&value))
    for (const std::int64_t each : *many) visit(each);
}

// an object brings along what it stands below and what its references name
void Briefing::meet(const Object& object, Tale& tale) {
  if (told(object.id)) return;
  if (told_.size() <= object.id) told_.resize(object.id + 1);
  told_[object.id] = 1;
  fresh_.push_back(&object);
  if (const Object* parent = world_.object(object.parent)) meet(*parent, tale);
  meet_type(*object.type, tale);
  const Interest& wanted = interest(*object.type);
  for (std::size_t i = 0; i < object.slots.size(); ++i)
    if (wanted.fields[i] != 0) meet_targets(*object.type->fields()[i], object.slots[i].value, tale);
}

void Briefing::introduce(Tale& tale, const std::vector<const Object*>& objects) {
  for (const Object* object : objects) told_[object->id] = ++count_told_;
  append_objects(tale.text, world_, objects, [&](const Object& object, const Field& field) {
    const int index = object.type->find(field);
    return wants(object, index) && !is_long(object.value(index));
  });
  for (const Object* object : objects) {
    const Interest& wanted = interest(*object->type);
    for (std::size_t i = 0; i < object->slots.size(); ++i)
      if (wanted.fields[i] != 0 && (object->type->fields()[i]->derived ||
                                    (is_long(object->slots[i].value) && !object->is_default(static_cast<int>(i)))))
        say(*object, static_cast<int>(i), tale);
  }
}

void Briefing::whole(Tale& tale) {
  const std::vector<const Type*> types = std::move(told_types_);
  told_types_.clear();
  told_fields_.clear();
  met_.clear();
  for (const Type* type : types) meet_type(*type, tale);
  // in the order in which it met them, which is the order in which it goes through them
  std::vector<const Object*> objects;
  for (ObjectId id = 0; id < told_.size(); ++id)
    if (told_[id] != 0)
      if (const Object* object = world_.object(id)) objects.push_back(object);
  std::sort(objects.begin(), objects.end(),
            [&](const Object* a, const Object* b) { return told_[a->id] < told_[b->id]; });
  count_told_ = 0;
  introduce(tale, objects);
}

void Briefing::own(Tale& tale) {
  std::erase_if(owned_, [&](const auto& each) {
    const Object* object = world_.object(each.first);
    return object == nullptr || !owns_now(*object, each.second);
  });
  std::vector<ObjectId> moved;
  for (const auto& [id, field] : owned_) {
    const Object* object = world_.object(id);
    if (!told(id)) continue;
    if (object->place && field == scene::Scene::parent)
      moved.push_back(id);
    else
      say(*object, field, tale);
  }
  for (const ObjectId node : world_.scene().top_down(moved))
    append_set(tale.text, world_, *world_.object(node), scene::Scene::parent);
}

// -- what changed

void Briefing::say(const Object& object, const Field& field, const Value& value, Tale& tale) {
  if (is_long(value))
    tale.arrays.push_back({tale.text.size(), {object.id, object.path, &field, std::get<Numbers>(value)}});
  else
    append_set(tale.text, world_, object.path, field, value);
}

void Briefing::say(const Object& object, int field, Tale& tale) {
  const Field& declared = object.type->field(field);
  if (declared.derived)
    append_set(tale.text, world_, object, field);
  else
    say(object, declared, object.value(field), tale);
}

void Briefing::say_held(Tale& tale) {
  const std::vector<Held> held = std::move(held_);
  held_.clear();
  for (const Held& each : held) {
    const Object* object = world_.object(each.object);
    if (object == nullptr || !told(each.object)) continue;
    const Field& field = object->type->field(each.field);
    Value value = each.value;
    if (field.holds_refs()) drop_dead(value, world_);
    say(*object, field, value, tale);
  }
}

void Briefing::changes(Tale& tale, std::uint64_t tick) {
  if (new_fields_) {
    new_fields_ = false;
    const std::vector<const Type*> types = told_types_;
    for (const Type* type : types) meet_type(*type, tale);
  }
  std::vector<std::pair<const Object*, int>> changes;
  world_.read_feed(feed_, [&](const Database::Event& event, const Object& object) {
    if (event.field == Database::Event::deleted) {
      if (!told(event.object)) return;
      // references to it go with it
      tale.text += "delete " + object.path + " force\n";
      told_[event.object] = 0;
      return;
    }
    if (event.field == Database::Event::created || !told(object.id)) {
      const bool of_interest =
          event.field == Database::Event::created ? interest(*object.type).any : wants(object, event.field);
      if (of_interest && serves(object)) meet(object, tale);
    } else if (wants(object, event.field) || owns_now(object, event.field)) {
      changes.emplace_back(&object, event.field);
    }
  });
  for (const auto& [object, field] : changes)
    if (wants(*object, field)) meet_targets(object->type->field(field), object->value(field), tale);
  std::sort(fresh_.begin(), fresh_.end(), [](const Object* a, const Object* b) { return a->id < b->id; });
  introduce(tale, fresh_);

  // what a delayed read held back in the last tick comes before the news
  say_held(tale);
  for (const auto& [object, field] : changes) {
    if (std::binary_search(fresh_.begin(), fresh_.end(), object,
                           [](const Object* a, const Object* b) { return a->id < b->id; }))
      continue;
    const Slot& slot = object->slots[static_cast<std::size_t>(field)];
    // nobody is told its own words
    if (slot.origin.source == reader_ && !object->type->field(field).derived) continue;
    const bool delayed = interest(*object->type).fields[static_cast<std::size_t>(field)] == 2;
    if (delayed && tick != 0 && slot.origin.tick == tick)
      held_.push_back({object->id, field, world_.value(*object, field)});
    else
      say(*object, field, tale);
  }
  fresh_.clear();
}

}  // namespace manager
