#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

void describe_type(std::string& out, const Type& type) {
  out += "type " + type.name();
  if (type.base() != nullptr) out += " extends " + type.base()->name();
  out += "\n";
  if (!type.doc().empty()) out += "    " + type.doc() + "\n";
  for (const Field* field : type.fields()) out += field->declaration() + "\n";
}

Outcome run(Call& call) {
  const Word& word = call.words[0];
  const Manager& manager = call.manager;
  if (const Type* type = manager.world.schema().find(word.text)) {
    describe_type(call.out, *type);
    return {};
  }
  if (const Command* command = find_command(word.text)) {
    call.out += std::string(command->name) + (command->syntax.empty() ? "" : " ") + std::string(command->syntax) +
                "\n    " + std::string(command->doc) + "\n";
    return {};
  }
  for (const auto& manipulator : manager.programs.all())
    for (const Manipulator::Verb& verb : manipulator->verbs())
      if (verb.name == word.text) {
        call.out += verb.name + (verb.syntax.empty() ? "" : " ") + verb.syntax + "\n    " + verb.doc + " (" +
                    manipulator->name + ")\n";
        return {};
      }
  const Result<const Object*> object = find_object(manager.world, word, call.scope);
  if (!object) return Error{object.error().kind, "no type, verb or object " + quote(word.text), word.column};
  call.out += (*object)->type->name() + " " + (*object)->path + "\n";
  for (int i = 0; i < static_cast<int>((*object)->slots.size()); ++i) {
    const Field& field = (*object)->type->field(i);
    call.out += "    " + field.name + " ";
    append_value(call.out, field, manager.world.value(**object, i), manager.world);
    const std::string unit = field.unit();
    call.out += "    # " + field.kind_text() + (unit.empty() ? "" : " " + unit) +
                (field.doc.empty() ? "" : ", " + field.doc) + "\n";
  }
  return {};
}

}  // namespace

extern const Command command_describe;
const Command command_describe = {
    "describe", "TYPE|PATH|VERB", "Tells what a type, an object or a verb is.", Effect::look, 1, 1, run};

}  // namespace manager
