#include "dialog_manager/rights.h"

#include <algorithm>

#include "dialog_manager/manager.h"

namespace manager {

using namespace objdb;

// does it write this field, or with null all of the object?
bool Rights::declared(const Object& object, const Field* field) const {
  const Declaration& declaration = program_.declared();
  return std::any_of(declaration.writes().begin(), declaration.writes().end(), [&](const Declaration::Access& access) {
    if (!access.field.empty() && (field == nullptr || access.field != field->name)) return false;
    const Type* type = manager_.world.schema().find(access.type);
    return type != nullptr && object.type->is(*type);
  });
}

Error Rights::not_served(const Object& object) const {
  return {ErrorKind::owner,
          object.path + " is not served by " + program_.name + " (serving " + program_.briefing().serving() + ")", 0};
}

Status Rights::may_write(const Object& object, int index) {
  const Field& field = object.type->field(index);
  const bool own = (field.is_private || field.measured) && program_.declared().brought(*object.type);
  if (!own && !declared(object, &field))
    return Error{ErrorKind::owner,
                 program_.name + " did not declare that it writes " + object.type->name() + "." + field.name, 0};
  if (!program_.briefing().serves(object)) return not_served(object);
  const std::uint16_t owner = object.slots[static_cast<std::size_t>(index)].owner;
  if (owner == program_.id) return {};
  if (owner != 0)
    return Error{ErrorKind::owner,
                 object.path + "." + field.name + " is written by " + manager_.source_name(owner) +
                     " already, expected one writer a field",
                 0};
  manager_.world.set_owner(object, index, program_.id);
  program_.briefing().owns(object, index);
  return {};
}

Status Rights::may_make(const Object& object) {
  if (!program_.declared().brought(*object.type) && !declared(object, nullptr))
    return Error{ErrorKind::owner,
                 program_.name + " did not declare that it writes " + object.type->name() + ": " + object.path +
                     " is not its own to make or delete",
                 0};
  if (!program_.serves_path(object.path)) return not_served(object);
  return {};
}

}  // namespace manager
