#include "dialog_manager/replay.h"

#include <algorithm>
#include <charconv>

#include "dialog_manager/array_file.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

constexpr int records_at_a_time = 20'000;

// figures of a machine are not figures of this one
bool sets_measured(const Database& world, const LineWords& words) {
  if (words.words()[0].text != "set" || words.words().size() < 2) return false;
  const std::string_view target = words.words()[1].text;
  const std::size_t dot = target.find('.');
  if (dot == std::string_view::npos) return false;
  const Object* object = world.find(target.substr(0, dot));
  const int field = object == nullptr ? -1 : object->type->find(target.substr(dot + 1, target.find('[') - dot - 1));
  return field >= 0 && object->type->field(field).measured;
}

// "put PATH.FIELD count=N at=BYTE check=HEX": the numbers stand beside the journal
Status restore_array(Manager& manager, const Source& source, Words words, std::string_view line,
                     const std::string& journal) {
  if (words.size() != 5) return Error{ErrorKind::syntax, "expected put PATH.FIELD count=N at=BYTE check=HEX", 0};
  const Result<Target> target = parse_target(words[1]);
  if (!target) return target.error();
  const Result<const Object*> object = find_object(manager.world, Word{target->pattern, 0, false}, {});
  if (!object) return object.error();
  const Result<int> field = find_field(**object, target->field, 0);
  if (!field) return field.error();
  if (source.gate != nullptr)
    if (Status allowed = source.gate->may_write(**object, *field); !allowed) return allowed;
  Result<std::vector<double>> numbers = ArrayFile::read(ArrayFile::path_of(journal), words.subspan(2));
  if (!numbers) return numbers.error();
  manager.dispatch.speak_as(source, line);
  return manager.world.set(**object, *field, std::move(*numbers));
}

// "ID START RUNS HELD at|every|when ...": put off before the journal began; "ID" alone is the number of the next
Outcome put_off_again(Manager& manager, const Record& record, Words words) {
  const Error wrong{ErrorKind::io, "expected ID START RUNS HELD and what was put off", 0};
  const Result<std::int64_t> id = parse_integer(words[0].text);
  if (id && words.size() == 1) {
    manager.schedule.number_from(static_cast<int>(*id));
    return {};
  }
  if (words.size() < 6) return wrong;
  const Result<std::int64_t> runs = parse_integer(words[2].text);
  const Result<double> start = parse_real(words[1].text, {});
  const std::string_view verb = words[4].text;
  if (!id || !runs || !start || (verb != "at" && verb != "every" && verb != "when")) return wrong;
  const std::string_view line = record.line.substr(static_cast<std::size_t>(words[4].column) - 1);
  LineWords inner;
  if (Status split = inner.split(line); !split) return split;
  std::string body;
  Outcome outcome = manager.dispatch.execute(*manager.main_session(), manager.main_session(), inner, line,
                                             Scope{std::string(record.prefix)}, body);
  if (outcome.status)
    manager.schedule.restore(static_cast<int>(*id), *start, static_cast<std::uint64_t>(*runs), words[3].text == "true");
  return outcome;
}

class Replay : public Operation {
 public:
  Replay(JournalText text, bool live) : text_(std::move(text)), live_(live) {}

  std::optional<Status> poll(Manager& manager, std::string& out) override {
    if (at_ == 0 && !begun_) begin(manager);
    if (inner_) {
      // a program that starts or ends
      const std::optional<Status> ended = inner_->poll(manager, out);
      if (!ended) return std::nullopt;
      inner_.reset();
      if (!*ended) return end(manager, *ended);
    }
    for (int i = 0; i < records_at_a_time; ++i) {
      if (at_ == text_.records.size()) return end(manager, {});
      const Record& record = text_.records[at_++];
      if (Status status = carry_out(manager, record); !status) {
        const Error& error = status.error();
        return end(manager, Error{error.kind,
                                  "tick " + std::to_string(record.tick) + ", " + std::string(record.source) + ": " +
                                      std::string(record.line.substr(0, 200)) + ": " + error.sentence,
                                  0});
      }
      if (inner_) return std::nullopt;
    }
    return std::nullopt;
  }

  std::optional<double> share(const Manager&) const override {
    return static_cast<double>(at_) / static_cast<double>(std::max<std::size_t>(1, text_.records.size()));
  }

  std::optional<std::chrono::steady_clock::time_point> deadline() const override {
    // more to do at once, unless a program is waited for
    if (inner_) return inner_->deadline();
    return std::chrono::steady_clock::time_point::min();
  }

 private:
  void begin(Manager& manager) {
    begun_ = true;
    manager.playback.replaying(true);
    manager.clock.set_rate(text_.start.rate);
    manager.clock.set(text_.start.tick, text_.start.time);
    manager.clock.compute_from(text_.start.base_tick, text_.start.base_time);
  }

  std::optional<Status> end(Manager& manager, Status status) {
    manager.playback.end(live_);
    return status;
  }

  Status carry_out(Manager& manager, const Record& record) {
    manager.playback.inside_tick(record.tick > manager.clock.tick() || record.source == tick_source);
    if (record.source == tick_source) return close_tick(manager, record);
    if (record.source == ask_source) return ask(manager, record);
    if (record.source == checkpoint_source) return checkpoint(manager, record);
    if (Status split = words_.split(record.line); !split) return split;
    if (words_.empty() || (live_ && sets_measured(manager.world, words_))) return {};
    const std::string_view verb = words_.words()[0].text;
    if (!live_ && (verb == "start" || verb == "end")) return {};
    if (live_) tell_before(manager, record);
    Outcome outcome = say_again(manager, record, words_, text_.path, live_);
    inner_ = std::move(outcome.operation);
    return outcome.status;
  }

  // lines of a tick come in the order of stages: who stands in a stage is told before what that stage said counts
  void tell_before(Manager& manager, const Record& record) {
    Manipulator* speaker = manager.programs.find(record.source);
    if (record.tick > manager.clock.tick()) {
      if (speaker != nullptr) tell_stages(manager, speaker->stage);
    } else if (speaker != nullptr && speaker->state() == Manipulator::State::active) {
      speaker->spoke_before();
    }
  }

  void tell_stages(Manager& manager, int last) {
    const std::uint64_t tick = manager.clock.tick() + 1;
    for (; told_stages_ <= last; ++told_stages_)
      for (const auto& manipulator : manager.programs.all())
        if (manipulator->stage == told_stages_ && manipulator->due(tick, manager.clock.rate()))
          manipulator->send_tick(tick, manager.clock.time_of(tick), manager.clock.step());
  }

  Status close_tick(Manager& manager, const Record& record) {
    const std::optional<TickLine> line = parse_tick(record);
    if (!line) return Error{ErrorKind::io, "no tick", 0};
    if (live_) tell_stages(manager, manager.programs.stages() - 1);
    told_stages_ = 0;
    manager.playback.tick();
    if (manager.clock.tick() != line->tick)
      return Error{
          ErrorKind::range,
          "the tick is " + std::to_string(manager.clock.tick()) + ", the journal says " + std::to_string(line->tick),
          0};
    const std::uint64_t hash = manager.hash();
    if (hash != line->hash)
      return Error{ErrorKind::range,
                   "the hash at tick " + std::to_string(line->tick) + " is another than the journal's", 0};
    return {};
  }

  Status ask(Manager& manager, const Record& record) {
    if (!live_) return {};
    // NAME NUMBER LINE
    const std::string_view line = record.line;
    const std::size_t name = line.find(' '), number = line.find(' ', name + 1);
    if (name == std::string_view::npos || number == std::string_view::npos)
      return Error{ErrorKind::io, "no command", 0};
    if (Manipulator* manipulator = manager.programs.find(line.substr(0, name))) {
      std::uint64_t value = 0;
      std::from_chars(line.data() + name + 1, line.data() + number, value);
      manipulator->asked_before(value, line.substr(number + 1));
    }
    return {};
  }

  Status checkpoint(Manager& manager, const Record& record) {
    if (!live_) return {};
    const std::string_view name = std::string_view(record.line).substr(0, record.line.find(' '));
    if (Manipulator* manipulator = manager.programs.find(name))
      manipulator->checkpoint_before(name.size() < record.line.size());
    return {};
  }

  JournalText text_;
  bool live_;
  bool begun_ = false;
  std::size_t at_ = 0;
  int told_stages_ = 0;
  std::unique_ptr<Operation> inner_;
  LineWords words_;
};

}  // namespace

std::optional<TickLine> parse_tick(const Record& record) {
  LineWords words;
  if (Status split = words.split(record.line); !split || words.words().size() != 3) return std::nullopt;
  const Words all = words.words();
  TickLine out{record.tick, 0, 0};
  const Result<double> time = parse_real(all[1].text, {});
  const std::string_view hash = all[2].text;
  if (!time || std::from_chars(hash.data(), hash.data() + hash.size(), out.hash, 16).ec != std::errc())
    return std::nullopt;
  out.time = *time;
  return out;
}

Outcome say_again(Manager& manager, const Record& record, const std::string& journal, bool owning) {
  LineWords words;
  if (Status split = words.split(record.line); !split) return split;
  return say_again(manager, record, words, journal, owning);
}

Outcome say_again(Manager& manager, const Record& record, const LineWords& words, const std::string& journal,
                  bool owning) {
  if (words.empty() || sets_measured(manager.world, words)) return {};
  if (record.source == later_source) return put_off_again(manager, record, words.words());
  const std::string_view verb = words.words()[0].text;
  Source source;
  source.name = record.source;
  source.id = manager.add_source(source.name);
  // so that it owns what it wrote
  if (owning && (verb == "set" || verb == "put"))
    if (const Manipulator* speaker = manager.programs.find(record.source)) source.gate = speaker->gate;
  if (verb == "put") return restore_array(manager, source, words.words(), record.line, journal);
  std::string body;
  return manager.dispatch.execute(source, manager.main_session(), words, record.line, Scope{std::string(record.prefix)},
                                  body);
}

bool is_journaled(const Command& command) {
  static constexpr std::string_view steering[] = {"rate",  "undo", "redo",   "begin", "commit", "rollback", "at",
                                                  "every", "when", "forget", "start", "end",    "budget"};
  return command.effect == Effect::change ||
         std::find(std::begin(steering), std::end(steering), command.name) != std::end(steering);
}

std::unique_ptr<Operation> replay(JournalText text, bool live) {
  return std::make_unique<Replay>(std::move(text), live);
}

std::vector<Record> records_until(std::vector<Record> records, const JournalStart& start, double time) {
  constexpr double rounding = 1e-9;
  // in its place: a journal may be long
  const auto first = records.begin();
  auto end = first;
  // the first record of the first tick beyond the time ends it
  const auto cut = [&](double until) {
    std::uint64_t tick = start.tick;
    for (auto record = first; record != end; ++record)
      if (record->source == tick_source)
        if (const auto line = parse_tick(*record); line && line->time <= until + rounding) tick = line->tick;
    end = std::find_if(first, end, [&](const Record& record) { return record.tick > tick; });
  };
  for (const Record& record : records) {
    if (record.source == rewind_source) {
      if (const Result<double> to = parse_real(record.line, {})) cut(*to);
    } else {
      *end++ = record;
    }
  }
  cut(time);
  records.erase(end, records.end());
  return records;
}

}  // namespace manager
