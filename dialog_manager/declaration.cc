#include "dialog_manager/declaration.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace manager {
namespace {

using namespace objdb;

Error error_at(const Word& word, ErrorKind kind, std::string sentence) {
  return {kind, std::move(sentence), word.column};
}

// the one number of `rate 60Hz`, more than 0 and less than `below`
Result<double> positive(Words words, std::string_view unit, double below) {
  if (words.size() != 2)
    return error_at(words.back(), ErrorKind::syntax, "expected " + std::string(words[0].text) + " and one number");
  Result<double> value = parse_real(words[1].text, parse_unit(unit)->dimension);
  if (value && !(*value > 0 && *value < below))
    return error_at(words[1], ErrorKind::range,
                    std::string(words[0].text) + " is " + std::string(words[1].text) + ", expected more than 0" +
                        (std::isfinite(below) ? " and less than " + number(below) : ""));
  return value;
}

// within the fields of the type that an access names?
bool within(const Declaration::Access& access, const Schema& schema, const Field& field) {
  const Type* type = schema.find(access.type);
  if (type == nullptr) return false;
  return access.field.empty() ? type->find(field) >= 0
                              : field.name == access.field && (type->is(*field.owner) || field.owner->is(*type));
}

}  // namespace

Status Declaration::take(Words words, Database& world) {
  const std::string_view verb = words[0].text;
  const Words rest = words.subspan(1);
  if (verb == "type") {
    const Result<const Type*> type = world.declare_type(rest);
    if (!type) return type.error();
    types_.push_back(*type);
    return {};
  }
  if (verb == "field") {
    const Result<const Field*> field = world.declare_field(rest);
    if (!field) return field.error();
    fields_.push_back(*field);
    checkpoint_ = checkpoint_ || (*field)->is_private;
    return {};
  }
  if (verb == "verb") {
    if (rest.empty() || rest.size() > 3 || !is_name(rest[0].text))
      return error_at(words.back(), ErrorKind::syntax, "expected verb NAME \"SYNTAX\" \"doc\"");
    verbs_.push_back({std::string(rest[0].text), rest.size() > 1 ? std::string(rest[1].text) : "",
                      rest.size() > 2 ? std::string(rest[2].text) : ""});
    return {};
  }
  if (verb == "reads" || verb == "writes") return take_access(words, world);
  if (verb == "rate") {
    const Result<double> value = positive(words, "Hz", HUGE_VAL);
    if (!value) return value.error();
    rate_ = *value;
    return {};
  }
  if (verb == "timeout") {
    const Result<double> value = positive(words, "s", 1e6);
    if (!value) return value.error();
    timeout_ = std::chrono::milliseconds(static_cast<long>(std::ceil(*value * 1000)));
    return {};
  }
  if (verb == "policy") {
    static constexpr std::string_view policies[] = {"stop", "hold", "skip"};
    const auto found =
        rest.size() == 1 ? std::find(std::begin(policies), std::end(policies), rest[0].text) : std::end(policies);
    if (found == std::end(policies))
      return error_at(words.back(), ErrorKind::syntax, "expected policy stop, hold or skip");
    policy_ = static_cast<Policy>(found - std::begin(policies));
    return {};
  }
  if (words.size() == 1 && (verb == "arrays=text" || verb == "arrays=shm")) {
    arrays_ = verb == "arrays=shm";
    return {};
  }
  if (words.size() == 1 && verb == "checkpoint") {
    checkpoint_ = true;
    return {};
  }
  return error_at(words[0], ErrorKind::unknown,
                  quote(verb.substr(0, 60)) +
                      " is no declaration (type field verb reads writes rate timeout policy "
                      "checkpoint arrays=text arrays=shm ready)");
}

Status Declaration::take_access(Words words, Database& world) {
  const bool reading = words[0].text == "reads";
  Words rest = words.subspan(1);
  if (rest.empty())
    return error_at(words[0], ErrorKind::syntax, "expected " + std::string(words[0].text) + " TYPE.FIELD ...");
  const bool delayed = reading && rest.back().text == "delayed";
  if (delayed) rest = rest.first(rest.size() - 1);
  for (const Word& word : rest) {
    const std::size_t dot = word.text.find('.');
    Access access{std::string(word.text.substr(0, dot)),
                  dot == std::string_view::npos ? "" : std::string(word.text.substr(dot + 1)), delayed};
    if (!is_name(access.type) || (dot != std::string_view::npos && !is_name(access.field)))
      return error_at(word, ErrorKind::syntax, quote(word.text) + " is not TYPE.FIELD");
    // a type that another program will bring may still be unknown; a wrong field of a known one is an error
    if (world.schema().find(access.type) != nullptr && !access.field.empty())
      if (const Result<const Field*> field = world.schema().field(word); !field) return field.error();
    (reading ? reads_ : writes_).push_back(std::move(access));
  }
  return {};
}

bool Declaration::brought(const Type& type) const {
  return std::any_of(types_.begin(), types_.end(), [&](const Type* own) { return type.is(*own); });
}

bool Declaration::declared(const Type& type) const {
  return std::find(types_.begin(), types_.end(), &type) != types_.end();
}

bool Declaration::declared(const Field& field) const {
  return std::find(fields_.begin(), fields_.end(), &field) != fields_.end();
}

bool Declaration::reads(const Schema& schema, const Field& field, bool* delayed) const {
  for (const Access& access : reads_) {
    if (!within(access, schema, field)) continue;
    if (delayed != nullptr) *delayed = access.delayed;
    return true;
  }
  return false;
}

bool Declaration::writes(const Schema& schema, const Field& field) const {
  return std::any_of(writes_.begin(), writes_.end(),
                     [&](const Access& access) { return within(access, schema, field); });
}

bool Declaration::reads_by_name(const Field& field, bool* delayed) const {
  for (const Access& access : reads_)
    if (access.field == field.name) {
      *delayed = access.delayed;
      return true;
    }
  return false;
}

}  // namespace manager
