#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/put_words.h"

namespace manager {
namespace {

using namespace objdb;

// does the field hold so many numbers?
Status check_count(const Object& object, const Field& field, std::size_t numbers) {
  const auto each = static_cast<std::size_t>(words_of(field.kind));
  const bool fits = numbers % each == 0 &&
                    (field.count == Field::any_length || numbers / each == static_cast<std::size_t>(field.count));
  if (fits) return {};
  return Error{ErrorKind::range,
               object.path + "." + field.name + " is a " + field.kind_text() + ", the slot holds " +
                   std::to_string(numbers) + " numbers",
               0};
}

Outcome run(Call& call) {
  Manager& manager = call.manager;
  Manipulator* speaker = call.source.gate == nullptr ? nullptr : manager.programs.find(call.source.name);
  if (speaker == nullptr)
    return call.error(-1, ErrorKind::owner, "put is said by programs that were given memory, expected set");
  std::uint64_t slot = 0, sequence = 0;
  std::vector<Word> all{call.verb};
  all.insert(all.end(), call.words.begin(), call.words.end());
  if (Status parsed = parse_put(all, slot, sequence); !parsed) return parsed;
  Result<Numbers> filled = speaker->arrays().take(call.words[0].text, sequence);
  if (!filled) return call.error(0, filled.error().kind, filled.error().sentence);

  const Result<Target> target = parse_target(call.words[0]);
  if (!target) return target.error();
  const Result<const Object*> found = find_object(manager.world, *target, call.scope);
  if (!found) return found.error();
  const Object& object = **found;
  const Result<int> index = find_field(object, target->field, target->field_column);
  if (!index) return index.error();
  const Field& field = object.type->field(*index);
  if (Status allowed = call.source.gate->may_write(object, *index); !allowed)
    return call.error(0, allowed.error().kind, allowed.error().sentence);
  if (Status fits = check_count(object, field, filled->size()); !fits)
    return call.error(0, fits.error().kind, fits.error().sentence);
  Value value = std::move(*filled);
  // that they are finite was seen when they were copied
  if (field.ranged || field.kind == Kind::quat)
    if (Status good = check_value(field, value); !good) return call.error(0, good.error().kind, good.error().sentence);
  if (manager.recorder.journal() != nullptr && !manager.playback.replaying()) {
    Result<std::string> kept = manager.recorder.journal()->add_array(std::get<Numbers>(value));
    if (!kept) return kept.error();
    call.kept = "put " + object.path + "." + field.name + " " + *kept;
  }
  manager.world.assign(object, *index, std::move(value));
  return {};
}

}  // namespace

extern const Command command_put;
const Command command_put = {
    "put",
    "PATH.FIELD slot=K seq=N",
    "A program announces that it has filled slot K of the memory that it was given for an array, for the Nth time; the "
    "world has the numbers then. K is N modulo 3.",
    Effect::change,
    3,
    3,
    run};

}  // namespace manager
