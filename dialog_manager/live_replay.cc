#include "dialog_manager/live_replay.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "dialog_manager/manager.h"
#include "dialog_manager/replay.h"

namespace manager {
namespace {

using namespace objdb;

// the values that count of every object, in order of creation
struct Picture {
  struct Seen {
    std::string path;
    const Type* type;
    std::vector<Value> values;
  };
  std::vector<Seen> objects;

  explicit Picture(const Database& world) {
    world.for_each("**", [&](const Object& object) {
      objects.push_back({object.path, object.type, {}});
      for (const Slot& slot : object.slots) objects.back().values.push_back(slot.value);
    });
  }
};

// of two arrays the first element that differs
std::size_t first_difference(const Field& field, const Value& a, const Value& b) {
  const auto* left = std::get_if<Numbers>(&a);
  const auto* right = std::get_if<Numbers>(&b);
  if (left == nullptr || right == nullptr) return 0;
  std::size_t i = 0;
  while (i < left->size() && i < right->size() && same_bits((*left)[i], (*right)[i])) ++i;
  return i / static_cast<std::size_t>(words_of(field.kind));
}

class LiveReplay : public Operation {
 public:
  explicit LiveReplay(JournalText text) : text_(std::move(text)) {}
  ~LiveReplay() override {
    if (manager_ != nullptr) manager_->playback.follow(false);
  }

  std::optional<Status> poll(Manager& manager, std::string& out) override {
    if (manager_ == nullptr) begin(manager);
    while (true) {
      if (inner_) {
        const std::optional<Status> ended = inner_->poll(manager, out);
        if (!ended) return std::nullopt;
        inner_.reset();
        if (!*ended) return at_record(text_.records[at_ - 1], ended->error());
      }
      if (awaited_) {
        if (manager.clock.tick() < awaited_->tick) return std::nullopt;
        const TickLine line = *awaited_;
        awaited_.reset();
        if (manager.hash() != line.hash) return Status(difference(manager, line.tick));
        begin_tick(manager);
      }
      if (at_ == text_.records.size()) return Status();
      const Record& record = text_.records[at_++];
      if (Status status = follow(manager, record); !status) return at_record(record, status.error());
    }
  }
  bool wants_tick(const Manager&) const override { return awaited_.has_value(); }
  std::optional<std::chrono::steady_clock::time_point> deadline() const override {
    return inner_ ? inner_->deadline() : std::nullopt;
  }

 private:
  void begin(Manager& manager) {
    manager_ = &manager;
    manager.playback.follow(true);
    manager.seed(text_.start.seed);
    manager.clock.set_rate(text_.start.rate);
    manager.clock.set(text_.start.tick, text_.start.time);
    manager.clock.compute_from(text_.start.base_tick, text_.start.base_time);
    begin_tick(manager);
  }

  // from here on the world can be taken back, to carry out what the journal says instead
  void begin_tick(Manager& manager) {
    manager.world.forget_history();
    mark_ = manager.world.mark();
    first_ = at_;
    asked_.clear();
  }

  static std::optional<Status> at_record(const Record& record, const Error& error) {
    return Status(Error{error.kind,
                        "tick " + std::to_string(record.tick) + ", " + std::string(record.source) + ": " +
                            std::string(record.line.substr(0, 200)) + ": " + error.sentence,
                        0});
  }

  Status follow(Manager& manager, const Record& record) {
    if (record.source == tick_source) {
      awaited_ = parse_tick(record);
      return awaited_ ? Status() : Status(Error{ErrorKind::io, "no tick", 0});
    }
    if (record.source == checkpoint_source) {
      // its state is written down where it was: who starts later under its types begins with that
      writing_down_ = record.line.find(' ') == std::string::npos;
      if (Manipulator* manipulator = manager.programs.find(record.line); writing_down_ && manipulator != nullptr)
        manipulator->want_checkpoint();
      return {};
    }
    if (record.source == ask_source) return ask(manager, record);
    // what programs said in ticks, on commands, and of their state, they say again
    const bool program = manager.programs.find(record.source) != nullptr;
    if (program && (record.tick > manager.clock.tick() || writing_down_ || asked_.contains(record.source))) return {};
    Outcome outcome = say_again(manager, record, text_.path, true);
    inner_ = std::move(outcome.operation);
    return outcome.status;
  }

  Status ask(Manager& manager, const Record& record) {
    // NAME NUMBER LINE
    const std::string_view line = record.line;
    const std::size_t name = line.find(' '), number = line.find(' ', name + 1);
    if (name == std::string_view::npos || number == std::string_view::npos)
      return Error{ErrorKind::io, "no command", 0};
    Manipulator* manipulator = manager.programs.find(line.substr(0, name));
    if (manipulator == nullptr) return Error{ErrorKind::gone, std::string(line.substr(0, name)) + " is gone", 0};
    asked_.insert(manipulator->name);
    inner_ = manager.dispatch.ask(*manipulator, line.substr(number + 1));
    return {};
  }

  // the tick again, as the journal tells it, and where that leads elsewhere
  Error difference(Manager& manager, std::uint64_t tick) {
    const Picture live(manager.world);
    manager.world.roll_back(mark_);
    manager.playback.replaying(true);
    for (std::size_t i = first_; i + 1 < at_; ++i) {
      const Record& record = text_.records[i];
      const std::string_view verb = std::string_view(record.line).substr(0, record.line.find(' '));
      if (record.source == ask_source || record.source == checkpoint_source || verb == "start" || verb == "end")
        continue;
      (void)say_again(manager, record, text_.path, false);
    }
    manager.playback.replaying(false);
    const Picture told(manager.world);
    return {ErrorKind::range, "tick " + std::to_string(tick) + ": " + compare(manager.world, live, told), 0};
  }

  static std::string compare(const Database& world, const Picture& live, const Picture& told) {
    for (std::size_t i = 0; i < std::max(live.objects.size(), told.objects.size()); ++i) {
      if (i >= told.objects.size()) return live.objects[i].path + " is there, the journal has no such object";
      const Picture::Seen& expected = told.objects[i];
      if (i >= live.objects.size() || live.objects[i].path != expected.path)
        return expected.path + " is not there, the journal has it";
      const Picture::Seen& is = live.objects[i];
      for (std::size_t k = 0; k < std::min(is.values.size(), expected.values.size()); ++k) {
        const Field& field = *is.type->fields()[k];
        if (field.hashed() && !same_bits(is.values[k], expected.values[k]))
          return is.path + "." + describe(world, field, is.values[k], expected.values[k]);
      }
    }
    return "the journal's lines lead to this world, its hash is another";
  }

  static std::string describe(const Database& world, const Field& field, const Value& is, const Value& expected) {
    std::string out = field.name;
    const std::size_t element = first_difference(field, is, expected);
    const bool one = field.array && element < element_count(field, is) && element < element_count(field, expected);
    const auto append = [&](const Value& value) {
      if (one)
        append_element(out, field, value, element, world);
      else if (field.array)
        out += std::to_string(element_count(field, value)) + " elements";
      else
        append_value(out, field, value, world);
    };
    if (one) out += "[" + std::to_string(element) + "]";
    out += " is ";
    append(is);
    out += ", the journal says ";
    append(expected);
    return out;
  }

  JournalText text_;
  Manager* manager_ = nullptr;
  std::size_t at_ = 0;
  std::size_t first_ = 0;   // first record since the last tick
  std::uint64_t mark_ = 0;  // and the world there
  bool writing_down_ = false;
  std::set<std::string, std::less<>> asked_;  // programs that were sent a command since
  std::optional<TickLine> awaited_;           // the tick that is under way
  std::unique_ptr<Operation> inner_;
};

}  // namespace

std::unique_ptr<Operation> live_replay(JournalText text) { return std::make_unique<LiveReplay>(std::move(text)); }

}  // namespace manager
