#include "dialog_manager/watches.h"

#include "dialog_manager/session.h"

namespace manager {

using namespace objdb;

void Watches::add(Session& session, std::string pattern, Scope scope) {
  if (!feed_) feed_ = world_.subscribe();
  watches_.push_back({&session, std::move(pattern), std::move(scope)});
}

void Watches::remove(const Session& session) {
  std::erase_if(watches_, [&](const Watch& watch) { return watch.session == &session; });
  if (!watches_.empty() || !feed_) return;
  world_.unsubscribe(*feed_);
  feed_.reset();
  held_.clear();
}

void Watches::tell(bool behind) {
  if (!feed_) return;
  if (!held_.empty() && !behind) {
    const auto held = std::exchange(held_, {});
    for (const auto& [id, field] : held)
      if (const Object* object = world_.object(id)) tell(*object, field);
  }
  if (!world_.has_events(*feed_)) return;
  world_.read_feed(*feed_, [&](const Database::Event& event, const Object& object) { tell(object, event.field); });
}

void Watches::tell(const Object& object, int field) {
  for (const Watch& watch : watches_) {
    const Result<Target> target = parse_target({watch.pattern, 0, false});
    if (!target || !matches(watch.scope.resolve(target->pattern), object.path)) continue;
    if (field == Database::Event::deleted)
      watch.session->event("event deleted " + object.path);
    else if (field == Database::Event::created)
      watch.session->event("event created " + object.type->name() + " " + object.path);
    else
      tell_value(watch, object, field, target->field);
  }
}

void Watches::tell_value(const Watch& watch, const Object& object, int field, std::string_view wanted) {
  const Field& declared = object.type->field(field);
  if (!wanted.empty() && !matches(wanted, declared.name)) return;
  if (watch.session->behind()) {
    held_.emplace(object.id, field);
    return;
  }
  std::string line = "event " + object.path + "." + declared.name + " ";
  append_value(line, declared, world_.value(object, field), world_);
  watch.session->event(line);
}

}  // namespace manager
