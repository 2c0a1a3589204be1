#include <cstdlib>
#include <string>

#include "objdb/database.h"

namespace {

using namespace objdb;

// one field of every kind and shape
struct Fields {
  Schema schema;
  LineWords words;

  void say(std::string_view text) {
    if (!words.split(text)) std::abort();
    const Words rest = words.words().subspan(1);
    if (!(words.words()[0].text == "type" ? schema.declare_type(rest).ok() : schema.declare_field(rest).ok()))
      std::abort();
  }

  Fields() {
    say("type t");
    for (const char* kind : {"bool",           "int",         "int in -5 5",
                             "real",           "real m",      "real deg in -90 90",
                             "vec3 m/s",       "vec3 in 0 1", "quat",
                             "word of a bb -", "text",        "ref",
                             "bool[2]",        "int[]",       "real[3] rad,m,kg",
                             "vec3[]",         "quat[2]",     "word[] of x y",
                             "text[]",         "text[3]",     "ref[]",
                             "ref:t[2]"})
      say("field t.f" + std::to_string(schema.find("t")->fields().size()) + " " + kind);
  }
};

struct OneObject : Names {
  Result<ObjectId> object(const Word& word, const Type*) const override {
    if (word.text == "it") return ObjectId{1};
    return Error{ErrorKind::unknown, "no object " + shown(word.text), word.column};
  }
  std::string_view path(ObjectId) const override { return "it"; }
};

}  // namespace

/// First byte: which field. The rest: a line of its value. What is accepted passes check_value, is printed, and reads
/// back to the same bits.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  static const Fields fields;
  static const OneObject names;
  if (size == 0) return 0;
  const Type& type = *fields.schema.find("t");
  const Field& field = type.field(data[0] % static_cast<int>(type.fields().size()));
  LineWords words;
  if (!words.split({reinterpret_cast<const char*>(data) + 1, size - 1}) || !words.tag().empty()) return 0;
  const Result<Value> value = parse_value(field, words.words(), names);
  if (!value) {
    if (!is_text(value.error().sentence) || value.error().sentence.size() > 1000) std::abort();
    return 0;
  }
  if (!check_value(field, *value)) std::abort();
  std::string printed;
  append_value(printed, field, *value, names);
  LineWords again;
  if (!again.split(printed)) std::abort();
  const Result<Value> twice = parse_value(field, again.words(), names);
  if (!twice || !same_bits(*value, *twice)) std::abort();
  return 0;
}
