#include "dialog_manager/completion.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "dialog_manager/manager.h"
#include "dialog_manager/script_file.h"

namespace manager {
namespace {

using namespace objdb;

/// One place of a syntax: the words, or names of what (in capitals), that may stand there.
struct Place {
  std::vector<std::string> words;
  bool optional = false;
  bool opens = false;  ///< it is the first of its brackets
  bool repeats = false;
};

bool is_name(std::string_view word) { return !word.empty() && word[0] >= 'A' && word[0] <= 'Z'; }

// "FILE.png [from CAMERA] [size WxH]": places divided by blanks, words by bars; FILE.png is a FILE
std::vector<Place> places(std::string_view syntax) {
  std::vector<Place> out;
  int depth = 0;
  bool opened = false, between = true;
  std::string word;
  const auto end_word = [&] {
    if (is_name(word)) word.resize(std::min(word.find_first_of(".="), word.size()));
    if (!word.empty() && word[0] != '.' && word[0] != '=') out.back().words.push_back(word);
    word.clear();
  };
  for (const char c : syntax) {
    if (c == '[' || c == '{') {
      // brackets within a word (PATTERN[.FIELD]) divide nothing
      ++depth;
      opened |= between;
      if (!between) end_word();
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ' ') {
      if (!between) end_word();
      between = true;
    } else if (c == '|') {
      if (!between) end_word();
    } else {
      if (between) {
        out.push_back({{}, depth > 0, opened, false});
        between = opened = false;
      }
      word += c;
    }
    if (word.ends_with("...")) out.back().repeats = true;
  }
  if (!between) end_word();
  return out;
}

class Offers {
 public:
  Offers(const Manager& manager, std::string line) : manager_(manager), line_(std::move(line)) {}

  Completion take() {
    const std::size_t blank = line_.find_last_of(" \t\"");
    out_.start = blank == std::string::npos ? 0 : blank + 1;
    word_ = line_.substr(out_.start);
    std::string_view before(line_.data(), out_.start);
    if (before.ends_with('"')) before.remove_suffix(1);
    LineWords words;
    if (words.split(before)) offer_line(words.words());
    std::sort(out_.words.begin(), out_.words.end());
    out_.words.erase(std::unique(out_.words.begin(), out_.words.end()), out_.words.end());
    return std::move(out_);
  }

 private:
  const Database& world() const { return manager_.world; }
  void offer(std::string_view candidate, const char* ending = " ") {
    if (candidate.starts_with(word_)) out_.words.push_back(std::string(candidate) + ending);
  }

  // a command, of which these words stand already
  void offer_line(Words before) {
    if (before.empty()) return offer_verbs();
    const std::string_view verb = before[0].text;
    const std::vector<Place> known = places(syntax_of(verb));
    const std::size_t index = before.size() - 1;
    // a command within a command
    for (std::size_t i = 0; i < known.size() && i <= index; ++i)
      if (known[i].words == std::vector<std::string>{"COMMAND"}) return offer_line(before.subspan(i + 1));
    if (verb == "when" && index > 0) offer_after_condition(before);
    if (verb == "create" && index >= 2) {
      offer_fields_and_values(before);
    } else if (!offer_values_after_field(before)) {
      offer_by_syntax(verb, known, index, before.back().text);
    }
    if (out_.words.empty())
      out_.hint = std::string(verb) + (syntax_of(verb).empty() ? "" : " ") + std::string(syntax_of(verb));
  }

  void offer_verbs() {
    for (const Command* command : commands()) offer(command->name, command->most == 0 ? "" : " ");
    for (const auto& manipulator : manager_.programs.all())
      for (const Manipulator::Verb& verb : manipulator->verbs()) offer(verb.name);
  }

  std::string_view syntax_of(std::string_view verb) const {
    if (const Command* command = find_command(verb)) return command->syntax;
    for (const auto& manipulator : manager_.programs.all())
      for (const Manipulator::Verb& each : manipulator->verbs())
        if (each.name == verb) return each.syntax;
    return {};
  }

  void offer_by_syntax(std::string_view verb, const std::vector<Place>& known, std::size_t index,
                       std::string_view previous) {
    // what a word of the syntax is followed by
    for (std::size_t i = 1; index > 0 && i < known.size(); ++i) {
      const auto& before = known[i - 1].words;
      const auto& here = known[i].words;
      if (is_name(previous) || std::find(before.begin(), before.end(), previous) == before.end()) continue;
      if (std::none_of(here.begin(), here.end(), is_name)) continue;
      for (const std::string& each : here)
        if (is_name(each)) offer_named(verb, each);
      return;
    }
    // what must stand first, then what may, up to what must again
    const auto first = std::find_if(known.begin(), known.end(), [](const Place& place) { return place.optional; });
    std::size_t i = std::min(index, static_cast<std::size_t>(first - known.begin()));
    if (i > 0 && index >= i && known[i - 1].repeats)
      for (const std::string& each : known[i - 1].words) offer_named(verb, each);
    for (bool on = true; on && i < known.size(); ++i) {
      on = known[i].optional;
      for (const std::string& each : known[i].words)
        if (!on || !is_name(each) || known[i].opens) offer_named(verb, each);
    }
  }

  void offer_named(std::string_view verb, const std::string& name) {
    if (!is_name(name)) {
      offer(name);
    } else if (name == "TYPE" || name == "BASE") {
      for (const auto& type : world().schema().types()) offer(type->name(), verb == "field" ? "." : " ");
    } else if (name == "VERB" || name == "WORD") {
      offer_verbs();
    } else if (name == "PROGRAM") {
      offer_programs();
    } else if (name == "FILE" || name == "FOLDER" || name == "FIFO" || name == "PICTURE") {
      offer_files();
      if (verb == "source") offer_scenes();
    } else if (name == "NAME" && verb == "end") {
      for (const auto& manipulator : manager_.programs.all()) offer(manipulator->name);
    } else if (name == "KIND") {
      for (const char* kind : {"bool", "int", "real", "vec3", "quat", "word", "text", "ref"}) offer(kind);
    } else if (name == "PATTERN" || name == "PATH" || name == "CONDITION" || name == "TARGET" || name == "FIGURE") {
      offer_paths({});
    } else {
      // what a program calls by the name of a type: ARM, CAMERA
      std::string type = name;
      for (char& c : type) c = static_cast<char>(c | 0x20);
      if (world().schema().find(type) != nullptr) offer_paths(type);
    }
  }

  // one level at a time, as file names are; PATH.FIELD when the dot has been typed. Of a type: only those, and what
  // stands above one
  void offer_paths(std::string_view type) {
    if (const std::size_t dot = word_.find('.'); dot != std::string::npos) {
      if (const Object* object = world().find(word_.substr(0, dot)))
        for (const Field* field : object->type->fields()) offer(object->path + "." + field->name);
      out_.hidden = dot + 1;
      return;
    }
    const Type* wanted = type.empty() ? nullptr : world().schema().find(type);
    const std::size_t folder = word_.rfind('/') + 1;  // 0 when there is none
    out_.hidden = folder;
    std::vector<std::string> found;
    bool children = false;
    world().for_each("**", [&](const Object& object) {
      if (!object.path.starts_with(word_) || (wanted != nullptr && !object.type->is(*wanted))) return;
      found.push_back(object.path.substr(0, object.path.find('/', folder)));
      children |= object.path.size() > word_.size() && object.path[word_.size()] == '/';
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    // a whole path goes on with its children, its fields, or not at all
    if (found.size() == 1 && found[0] == word_) {
      if (wanted == nullptr || children) offer(word_ + (children ? "/" : "."), "");
      if (wanted == nullptr && children) offer(word_ + ".", "");
      return;
    }
    for (const std::string& each : found) offer(each, "");
  }

  void offer_fields_and_values(Words before) {
    const Type* type = world().schema().find(before[1].text);
    if (type == nullptr) return;
    if (const int last = type->find(before.back().text); last >= 0 && before.size() > 3)
      return offer_values(type->field(last));
    for (const Field* field : type->fields())
      if (!field->derived) offer(field->name);
  }

  // the words of an enumeration, objects for a reference
  void offer_values(const Field& field) {
    if (field.kind == Kind::word)
      for (const std::string& each : field.words) offer(each);
    if (field.kind == Kind::boolean)
      for (const char* each : {"true", "false"}) offer(each);
    if (field.kind == Kind::ref) offer_paths({});
  }

  const Field* field_at(const Word& word) const {
    const Result<Target> target = parse_target(word);
    if (!target || target->field.empty()) return nullptr;
    const Object* object = world().find(target->pattern);
    const int field = object == nullptr ? -1 : object->type->find(target->field);
    return field < 0 ? nullptr : &object->type->field(field);
  }

  bool offer_values_after_field(Words before) {
    const bool sets = before[0].text == "set" && before.size() == 2;
    const std::string_view last = before.back().text;
    const bool compares = before.size() >= 3 && (last == "==" || last == "!=");
    const Field* field = sets ? field_at(before.back()) : compares ? field_at(before[before.size() - 2]) : nullptr;
    if (field == nullptr) return false;
    offer_values(*field);
    return true;
  }

  // FIELD OP VALUE, and then a command
  void offer_after_condition(Words before) {
    constexpr std::size_t condition = 3;
    if (before.size() > condition && before[2].text != "+-") offer_line(before.subspan(condition + 1));
  }

  void offer_folder(const std::filesystem::path& folder, const std::string& shown, const auto& wanted) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
      const std::string name = entry.path().filename().string();
      const bool is_folder = entry.is_directory(ignored);
      if (name.starts_with('.') && !word_.ends_with('.')) continue;
      if (is_folder || wanted(entry.path())) offer(shown + name, is_folder ? "/" : " ");
    }
  }

  void offer_files() {
    const std::size_t folder = word_.rfind('/') + 1;
    out_.hidden = folder;
    const std::string shown = word_.substr(0, folder);
    offer_folder(shown.empty() ? "." : shown, shown, [](const auto&) { return true; });
  }

  // the installed ones, as they are named from anywhere
  void offer_scenes() {
    const std::string shown = word_.substr(0, word_.rfind('/') + 1);
    for (const std::string& folder : script_folders(manager_.options().program_folder))
      offer_folder(std::filesystem::path(folder) / shown, shown,
                   [](const auto& file) { return file.extension() == ".dlg"; });
  }

  void offer_programs() {
    const auto runs = [](const std::filesystem::path& file) { return ::access(file.c_str(), X_OK) == 0; };
    if (word_.find('/') != std::string::npos) {
      out_.hidden = word_.rfind('/') + 1;
      const std::string shown = word_.substr(0, out_.hidden);
      return offer_folder(shown, shown, runs);
    }
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(manager_.options().program_folder, ignored)) {
      const std::string name = entry.path().filename().string();
      const bool program = name != "dialog_manager" && name.find('.') == std::string::npos &&
                           !name.ends_with("_bench") && !name.ends_with("_test");
      if (program && entry.is_regular_file(ignored) && runs(entry.path())) offer(name);
    }
  }

  const Manager& manager_;
  std::string line_, word_;
  Completion out_;
};

}  // namespace

Completion complete(const Manager& manager, const std::string& line) { return Offers(manager, line).take(); }

}  // namespace manager
