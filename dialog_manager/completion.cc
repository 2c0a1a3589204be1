#include "dialog_manager/completion.h"

#include <algorithm>

#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

class Candidates {
 public:
  explicit Candidates(std::string word) : word_(std::move(word)) {}
  void offer(std::string candidate) {
    if (candidate.starts_with(word_)) out_.push_back(std::move(candidate));
  }
  std::vector<std::string> take() {
    std::sort(out_.begin(), out_.end());
    out_.erase(std::unique(out_.begin(), out_.end()), out_.end());
    return std::move(out_);
  }

 private:
  std::string word_;
  std::vector<std::string> out_;
};

void offer_verbs(Candidates& out, const Manager& manager) {
  for (const Command* command : commands()) out.offer(std::string(command->name));
  for (const auto& manipulator : manager.programs.all())
    for (const Manipulator::Verb& verb : manipulator->verbs()) out.offer(verb.name);
}

// a path, or PATH.FIELD when the dot has been typed
void offer_paths(Candidates& out, const Database& world, const std::string& word) {
  const std::size_t dot = word.find('.');
  if (dot == std::string::npos) {
    world.for_each("**", [&](const Object& object) { out.offer(object.path); });
    return;
  }
  if (const Object* object = world.find(word.substr(0, dot)))
    for (const Field* field : object->type->fields()) out.offer(object->path + "." + field->name);
}

// the words of an enumeration, objects for a reference
void offer_values(Candidates& out, const Database& world, const Field& field, const std::string& word) {
  if (field.kind == Kind::word)
    for (const std::string& each : field.words) out.offer(each);
  if (field.kind == Kind::boolean)
    for (const char* each : {"true", "false"}) out.offer(each);
  if (field.kind == Kind::ref) offer_paths(out, world, word);
}

}  // namespace

std::vector<std::string> complete(const Manager& manager, const std::string& line, std::size_t start,
                                  const std::string& word) {
  Candidates out(word);
  const Database& world = manager.world;
  LineWords words;
  if (Status split = words.split(std::string_view(line).substr(0, start)); !split) return {};
  const Words before = words.words();
  if (before.empty()) {
    offer_verbs(out, manager);
    return out.take();
  }
  const std::string_view verb = before[0].text;
  if ((verb == "create" || verb == "describe" || verb == "field") && before.size() == 1)
    for (const auto& type : world.schema().types()) out.offer(type->name());
  if ((verb == "help" || verb == "describe") && before.size() == 1) offer_verbs(out, manager);
  if (verb == "end" && before.size() == 1)
    for (const auto& manipulator : manager.programs.all()) out.offer(manipulator->name);
  if (verb == "create" && before.size() >= 3) {
    if (const Type* type = world.schema().find(before[1].text)) {
      const int last = type->find(before.back().text);
      if (last >= 0)
        offer_values(out, world, type->field(last), word);
      else
        for (const Field* field : type->fields())
          if (!field->derived) out.offer(field->name);
    }
    return out.take();
  }
  // after PATH.FIELD its values
  if (before.size() >= 2)
    if (const Result<Target> target = parse_target(before[before.size() - 1]); target && !target->field.empty())
      if (const Object* object = world.find(target->pattern))
        if (const int field = object->type->find(target->field); field >= 0) {
          offer_values(out, world, object->type->field(field), word);
          return out.take();
        }
  offer_paths(out, world, word);
  return out.take();
}

}  // namespace manager
