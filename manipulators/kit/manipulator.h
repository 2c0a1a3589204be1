#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "manipulators/kit/shared_array.h"
#include "objdb/database.h"
#include "objdb/statement.h"

/// What the author of a manipulator needs: say what the program brings, keep a mirror of the part of the world that it
/// reads, answer ticks and verbs. Standard input and output, one thread, no event loop.
///
///   kit::Manipulator me("wave", R"(
///     type wave extends node "moves along y"
///     field wave.height real m = 0.1 "from the middle to the top"
///     reads wave
///     writes wave.position
///   )");
///   me.on_tick([&](const kit::Tick& tick) {
///     for (const objdb::Object* wave : me.objects("wave"))
///       me.set(*wave, "position", objdb::Vec3{0, me.get<double>(*wave, "height") * std::sin(tick.time), 0});
///   });
///   return me.run();
namespace kit {

/// One step of simulated time: it ends at `time`, and began `step` seconds before.
struct Tick {
  std::uint64_t number = 0;
  double time = 0;  ///< s
  double step = 0;  ///< s
};

/// What the manager says first.
struct Hello {
  std::string name;        ///< under which the program was started
  std::uint64_t seed = 0;  ///< for whatever is drawn by chance
  double tick = 1.0 / 60;  ///< s, length of a tick
};

/// What the scene wants of programs that can choose between methods: at most this error, or this time a tick.
struct Budget {
  enum class Of { nothing, error, time } of = Of::nothing;
  double value = 0;  ///< m or rad, as the program's own errors are; or s
};

class Manipulator {
 public:
  /// `declarations`: lines of the language (type field verb reads writes rate timeout policy), blanks before them do
  /// not count. A wrong type or field line is a mistake of the program's own and asserts.
  Manipulator(std::string name, std::string_view declarations);

  /// Called at every tick, when all that changed is in world(). What it sets is the program's answer.
  void on_tick(std::function<void(const Tick&)> handler) { tick_ = std::move(handler); }
  /// Called when a person says the verb; the words after it. The text is the body of the reply ("" for none), lines
  /// with their newlines.
  void on_verb(std::string verb, std::function<objdb::Result<std::string>(objdb::Words)> handler) {
    verbs_[std::move(verb)] = std::move(handler);
  }
  /// Called now and then: write what a fresh process would need to go on into fields declared `private`. A program
  /// that remembers nothing gives an empty handler: then a restart tells it no more than the world.
  void on_checkpoint(std::function<void()> handler) { checkpoint_ = std::move(handler); }

  /// The mirror: every object of the types that the program declared, and what else it reads. Current at every tick
  /// and verb.
  objdb::Database& world() { return world_; }
  const Hello& hello() const { return hello_; }
  /// What was last said by `budget`.
  const Budget& budget() const { return budget_; }

  /// Objects of a type and its subtypes, in order of creation; none when the type is not known (yet).
  std::vector<const objdb::Object*> objects(std::string_view type) const;
  /// The object that a word of a verb names. Errors: syntax, unknown; type, when it is none of `type`.
  objdb::Result<const objdb::Object*> object(const objdb::Word& word, std::string_view type = "") const;
  /// A field of an object; T as in objdb::Value. The field must exist and be of that kind.
  template <class T>
  const T& get(const objdb::Object& object, std::string_view field) const {
    return world_.get<T>(object, field);
  }
  /// The numbers of an array of real, vec3 or quat, where they stand: until the next tick or verb.
  std::span<const double> numbers(const objdb::Object& object, std::string_view field) const {
    return get<objdb::Numbers>(object, field).span();
  }
  /// The object that a ref field points to, null for none.
  const objdb::Object* target(const objdb::Object& object, std::string_view field) const;
  /// The word of a word field.
  std::string_view word(const objdb::Object& object, std::string_view field) const;

  /// Sets a field, here and in the world; says nothing when it has that value already. The numbers of a long array go
  /// through shared memory where the manager offers it; nothing else need be done for it, here or by those who read
  /// it with numbers(). A value that the field does not take (out of range, not finite) is a mistake of the program's
  /// own: it is refused, told on standard error.
  void set(const objdb::Object& object, std::string_view field, objdb::Value value);
  /// Sets an array of real, vec3 or quat to `count` numbers, which `write` puts, all of them, where others will read
  /// them: a long array is written once and copied by nobody here. What stands there before is anything.
  void fill(const objdb::Object& object, std::string_view field, std::size_t count,
            const std::function<void(std::span<double>)>& write);
  /// Sets a word field by its word.
  void set_word(const objdb::Object& object, std::string_view field, std::string_view word);
  /// Says a line as it stands: `pause`, `create ...` of a type it declared, `listen FIFO`.
  void say(std::string_view line);

  /// Serves until `quit` or the end of the input. The exit status.
  int run();

 private:
  bool read_line(std::string& line);
  void hear(std::string_view line);
  void hear_world(const objdb::LineWords& words);
  void hear_array(objdb::Words words);
  void hear_put(objdb::Words words);
  void hear_hello(objdb::Words words);
  void hear_budget(objdb::Words words);
  void refuse_to_serve(const objdb::Error& error);
  void answer(const objdb::LineWords& words);
  void flush();

  struct Arrays {
    std::shared_ptr<SharedArray> fill, read;
    std::size_t announced = 0;  // since the last tick
  };
  /// Memory for so many numbers of a field, when there is some that the manager has looked at.
  Arrays* to_fill(const objdb::Object& object, int field, std::size_t count);
  void announce(const objdb::Object& object, int field, Arrays& arrays);

  std::string name_;
  std::string declarations_;
  objdb::Database world_;
  Hello hello_;
  Budget budget_;
  std::function<void(const Tick&)> tick_;
  std::function<void()> checkpoint_;
  std::map<std::string, std::function<objdb::Result<std::string>(objdb::Words)>, std::less<>> verbs_;
  std::vector<char> arrived_;  // by the latest read
  std::string input_, output_;
  std::size_t read_ = 0;
  objdb::LineWords words_;
  bool quit_ = false;
  int status_ = 0;
  std::map<std::pair<objdb::ObjectId, int>, Arrays> arrays_;
};

}  // namespace kit
