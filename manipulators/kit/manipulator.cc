#include "manipulators/kit/manipulator.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>

namespace kit {
namespace {

using namespace objdb;

// the language that is spoken here
constexpr std::string_view protocol = "1";

void complain(const std::string& sentence) { std::fprintf(stderr, "%s\n", sentence.c_str()); }

template <class T>
T parse(std::string_view text, T missing) {
  T value = missing;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// SAILOR_ARRAYS=text: as from another machine
bool arrays_wanted() {
  const char* wanted = std::getenv("SAILOR_ARRAYS");
  return wanted == nullptr || std::string_view(wanted) != "text";
}

}  // namespace

Manipulator::Manipulator(std::string name, std::string_view declarations) : name_(std::move(name)), arrived_(65536) {
  hello_.name = name_;
  // a long array that comes every tick takes memory that is there already
  ::mallopt(M_MMAP_THRESHOLD, 64 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 128 << 20);
  LineWords line;
  while (!declarations.empty()) {
    const std::size_t end = declarations.find('\n');
    std::string_view text = declarations.substr(0, end);
    declarations.remove_prefix(end == std::string_view::npos ? declarations.size() : end + 1);
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    if (const Status split = line.split(text); !split) complain(name_ + ": " + split.error().sentence);
    if (line.empty()) continue;
    const Words rest = line.words().subspan(1);
    Status declared;
    if (line.words()[0].text == "type") {
      if (const auto type = world_.declare_type(rest); !type) declared = type.error();
    } else if (line.words()[0].text == "field") {
      if (const auto field = world_.declare_field(rest); !field) declared = field.error();
    }
    if (!declared) complain(name_ + ": " + std::string(text) + ": " + declared.error().sentence);
    assert(declared.ok());
    declarations_.append(text).append("\n");
  }
}

std::vector<const Object*> Manipulator::objects(std::string_view type) const {
  const Type* known = world_.schema().find(type);
  return known == nullptr ? std::vector<const Object*>() : world_.objects_of(*known);
}

Result<const Object*> Manipulator::object(const Word& word, std::string_view type) const {
  const Result<ObjectId> id = world_.object(word, type.empty() ? nullptr : world_.schema().find(type));
  if (!id) return id.error();
  return world_.Database::object(*id);
}

const Object* Manipulator::target(const Object& object, std::string_view field) const {
  return world_.object(static_cast<ObjectId>(get<std::int64_t>(object, field)));
}

std::string_view Manipulator::word(const Object& object, std::string_view field) const {
  const int index = object.type->find(field);
  return object.type->field(index).words[static_cast<std::size_t>(std::get<std::int64_t>(object.value(index)))];
}

void Manipulator::set(const Object& object, std::string_view field, Value value) {
  const int index = object.type->find(field);
  assert(index >= 0);
  if (same_bits(object.value(index), value)) return;
  if (Status status = world_.set(object, index, std::move(value)); !status) {
    complain(status.error().sentence);
    return;
  }
  const auto* numbers = std::get_if<Numbers>(&object.value(index));
  Arrays* arrays = numbers == nullptr ? nullptr : to_fill(object, index, numbers->size());
  if (arrays == nullptr) {
    append_set(output_, world_, object, index);
    return;
  }
  std::copy(numbers->begin(), numbers->end(), arrays->fill->begin(numbers->size()).begin());
  announce(object, index, *arrays);
}

void Manipulator::fill(const Object& object, std::string_view field, std::size_t count,
                       const std::function<void(std::span<double>)>& write) {
  const int index = object.type->find(field);
  assert(index >= 0);
  Arrays* arrays = to_fill(object, index, count);
  if (arrays == nullptr) {
    std::vector<double> numbers(count);
    write(numbers);
    set(object, field, Numbers(std::move(numbers)));
    return;
  }
  write(arrays->fill->begin(count));
  Value value = arrays->fill->begun();
  if (same_bits(object.value(index), value)) return;
  if (Status status = world_.set(object, index, std::move(value)); !status) {
    complain(status.error().sentence);
    return;
  }
  announce(object, index, *arrays);
}

Manipulator::Arrays* Manipulator::to_fill(const Object& object, int field, std::size_t count) {
  const auto found = arrays_.find({object.id, field});
  if (found == arrays_.end() || !found->second.fill || count > found->second.fill->capacity()) return nullptr;
  // what was announced in this tick may not have been taken yet: its slot is not filled again
  return found->second.announced + 1 < found->second.fill->slots() ? &found->second : nullptr;
}

void Manipulator::announce(const Object& object, int field, Arrays& arrays) {
  ++arrays.announced;
  const std::uint64_t sequence = arrays.fill->finish();
  output_ += "put " + object.path + "." + object.type->field(field).name +
             " slot=" + std::to_string(arrays.fill->slot_of(sequence)) + " seq=" + std::to_string(sequence) + "\n";
}

void Manipulator::set_word(const Object& object, std::string_view field, std::string_view word) {
  const Field& declared = object.type->field(object.type->find(field));
  for (std::size_t i = 0; i < declared.words.size(); ++i)
    if (declared.words[i] == word) {
      set(object, field, static_cast<std::int64_t>(i));
      return;
    }
  assert(false && "no such word");
}

void Manipulator::say(std::string_view line) { output_.append(line).append("\n"); }

void Manipulator::flush() {
  std::string_view rest = output_;
  while (!rest.empty()) {
    const ssize_t count = ::write(STDOUT_FILENO, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      // the manager is gone, and so is the reason to be
      quit_ = true;
      break;
    }
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  output_.clear();
}

bool Manipulator::read_line(std::string& line) {
  while (true) {
    const std::size_t newline = input_.find('\n', read_);
    if (newline != std::string::npos) {
      line.assign(input_, read_, newline - read_);
      read_ = newline + 1;
      return true;
    }
    // nothing more to do without waiting: now the manager may have what was said
    flush();
    if (quit_) return false;
    input_.erase(0, read_);
    read_ = 0;
    const ssize_t count = ::read(STDIN_FILENO, arrived_.data(), arrived_.size());
    if (count == 0 || (count < 0 && errno != EINTR)) return false;
    if (count > 0) input_.append(arrived_.data(), static_cast<std::size_t>(count));
  }
}

int Manipulator::run() {
  if (::isatty(STDIN_FILENO) != 0) {
    complain(name_ + " is a manipulator: the dialog manager starts it (start " + name_ + "). See " + name_ +
             " --help.");
    return 2;
  }
  std::string line;
  while (!quit_ && read_line(line)) hear(line);
  flush();
  return status_;
}

void Manipulator::hear(std::string_view line) {
  if (const Status split = words_.split(line); !split || words_.empty()) return;
  const std::string_view verb = words_.words()[0].text;
  const Words rest = words_.words().subspan(1);
  if (!words_.tag().empty()) {
    answer(words_);
  } else if (verb == "set" || verb == "create" || verb == "delete" || verb == "type" || verb == "field") {
    hear_world(words_);
  } else if (verb == "tick" && rest.size() == 3) {
    for (auto& [field, arrays] : arrays_) arrays.announced = 0;
    const Tick tick{parse<std::uint64_t>(rest[0].text, 0), parse(rest[1].text, 0.0), parse(rest[2].text, 0.0)};
    if (tick_) tick_(tick);
    say("done " + std::to_string(tick.number));
  } else if (verb == "checkpoint") {
    if (checkpoint_) checkpoint_();
    say("done");
  } else if (verb == "put") {
    hear_put(rest);
  } else if (verb == "array") {
    hear_array(rest);
  } else if (verb == "hello") {
    hear_hello(rest);
  } else if (verb == "budget") {
    hear_budget(rest);
  } else if (verb == "quit") {
    quit_ = true;
  }
}

void Manipulator::hear_hello(Words words) {
  bool shares = false;
  std::string_view spoken = "1";
  for (const Word& word : words) {
    const std::size_t equals = word.text.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view key = word.text.substr(0, equals), value = word.text.substr(equals + 1);
    if (key == "protocol") spoken = value;
    if (key == "name") hello_.name = value;
    if (key == "seed") hello_.seed = parse<std::uint64_t>(value, 0);
    if (key == "probe") shares = shares_memory(std::string(value)) && arrays_wanted();
    if (key == "tick") hello_.tick = parse(value, hello_.tick);
  }
  if (spoken != protocol) {
    refuse_to_serve(
        {ErrorKind::unknown, "protocol is " + std::string(spoken) + ", expected " + std::string(protocol), 0});
    return;
  }
  output_ += declarations_;
  if (checkpoint_) say("checkpoint");
  say(shares ? "arrays=shm" : "arrays=text");
  say("ready");
}

// the manager tells it to whoever started the program
void Manipulator::refuse_to_serve(const Error& error) {
  say("error " + std::string(name_of(error.kind)) + " 1 " + error.sentence);
  quit_ = true;
  status_ = 1;
}

void Manipulator::hear_budget(Words words) {
  budget_ = {};
  if (words.size() != 2) return;
  budget_.of = words[0].text == "time" ? Budget::Of::time : Budget::Of::error;
  budget_.value = parse(words[1].text, 0.0);
}

// "array PATH.FIELD fill=PATH capacity=N", or read=
void Manipulator::hear_array(Words words) {
  const Result<Target> target = words.size() == 3 ? parse_target(words[0]) : Error{ErrorKind::syntax, {}, 0};
  const Object* object = target ? world_.find(target->pattern) : nullptr;
  const int field = object == nullptr ? -1 : object->type->find(target->field);
  if (field < 0) return;
  const bool fill = words[1].text.starts_with("fill=");
  Arrays& arrays = arrays_[{object->id, field}];
  (fill ? arrays.fill : arrays.read) = SharedArray::open(std::string(words[1].text.substr(5)), fill);
}

// "put PATH.FIELD slot=K seq=N"
void Manipulator::hear_put(Words words) {
  const Result<Target> target = words.size() == 3 ? parse_target(words[0]) : Error{ErrorKind::syntax, {}, 0};
  const Object* object = target ? world_.find(target->pattern) : nullptr;
  const int field = object == nullptr ? -1 : object->type->find(target->field);
  const auto shared = field < 0 ? arrays_.end() : arrays_.find({object->id, field});
  const auto number = [&](std::size_t word, std::string_view key) {
    return parse<std::uint64_t>(words[word].text.starts_with(key) ? words[word].text.substr(key.size()) : "", 0);
  };
  std::optional<Numbers> numbers;
  if (shared != arrays_.end() && shared->second.read)
    numbers = shared->second.read->read(number(1, "slot="), number(2, "seq="));
  if (!numbers) {
    // with a wrong world nothing right can be said: the next life is told it as text
    complain("the array of " + std::string(words.empty() ? "" : words[0].text) + " cannot be read");
    quit_ = true;
    status_ = 3;
    return;
  }
  world_.assign(*object, field, std::move(*numbers));
}

void Manipulator::hear_world(const LineWords& words) {
  const std::string_view verb = words.words()[0].text;
  const Words rest = words.words().subspan(1);
  const Scope top;
  Status status;
  if (verb == "set") {
    status = set_statement(world_, rest, top);
    // derived fields are told to programs that keep no scene; this one computes them
    if (!status && status.error().kind == ErrorKind::owner) return;
  } else if (verb == "create") {
    if (const auto id = create_statement(world_, rest, top); !id) status = id.error();
  } else if (verb == "delete") {
    status = delete_statement(world_, rest, top);
    std::erase_if(arrays_, [this](const auto& each) { return world_.object(each.first.first) == nullptr; });
  } else if (verb == "type") {
    if (const auto type = world_.declare_type(rest); !type) status = type.error();
  } else {
    if (const auto field = world_.declare_field(rest); !field) status = field.error();
  }
  if (!status) complain("the mirror refused a line: " + status.error().sentence);
}

void Manipulator::answer(const LineWords& words) {
  const std::string tag(words.tag());
  const auto handler = verbs_.find(words.words()[0].text);
  const Result<std::string> reply =
      handler == verbs_.end()
          ? Result<std::string>(Error{ErrorKind::unknown, "no verb " + quote(words.words()[0].text), 1})
          : handler->second(words.words().subspan(1));
  if (!reply) {
    const Error& error = reply.error();
    say("@" + tag + " error " + std::string(name_of(error.kind)) + " " + std::to_string(std::max(error.column, 1)) +
        " " + error.sentence);
    return;
  }
  std::string_view body = *reply;
  while (!body.empty()) {
    const std::size_t end = body.find('\n');
    output_.append("  ").append(body.substr(0, end)).append("\n");
    body.remove_prefix(end == std::string_view::npos ? body.size() : end + 1);
  }
  say("@" + tag + " ok");
}

}  // namespace kit
