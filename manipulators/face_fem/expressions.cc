#include "manipulators/face_fem/expressions.h"

#include <algorithm>
#include <cassert>
#include <map>

#include "manipulators/face_fem/action_units.h"
#include "objdb/text.h"
#include "objdb/unit.h"

namespace face {
namespace {

using Kind = NamedExpression::Kind;
using objdb::Error;
using objdb::ErrorKind;

constexpr NamedExpression table[] = {
    {"smile", Kind::expression, "AU6=0.7 AU12=0.85 AU25=0.3", 0.4, 0.6, "happiness"},
    {"frown", Kind::expression, "AU4=1 AU15=0.8 AU17=0.4", 0.4, 0.5, "displeased: brows down, corners down"},
    {"surprise", Kind::expression, "AU1=1 AU2=1 AU5=0.8 AU25=0.5 AU26=0.8", 0.15, 0.5, "surprise"},
    {"fear", Kind::expression, "AU1=1 AU2=0.6 AU4=0.6 AU5=1 AU7=0.4 AU11=0.2 AU20=0.9 AU25=0.6 AU26=0.4", 0.15, 0.5,
     "fear"},
    {"anger", Kind::expression, "AU4=1 AU5=0.5 AU7=0.7 AU17=0.3 AU23=0.8 AU24=0.5", 0.3, 0.6, "anger"},
    {"disgust", Kind::expression, "AU4=0.3 AU6=0.4 AU9=1 AU10=0.6 AU15=0.5 AU17=0.5", 0.3, 0.5, "disgust"},
    {"sadness", Kind::expression, "AU1=1 AU4=0.6 AU15=0.9 AU17=0.5 AU43=0.15", 0.6, 0.8, "sadness"},
    {"contempt", Kind::expression, "AU12L=0.35 AU14L=1", 0.3, 0.5, "contempt, on one side"},
    {"pucker", Kind::expression, "AU18=1", 0.25, 0.3, "kissing lips"},
    {"blink", Kind::expression, "AU45=1", 0.07, 0.15, "both eyes shut"},
    {"wink", Kind::expression, "AU45L=1 AU6L=0.6 AU12L=0.15", 0.1, 0.2, "the left eye shut"},
    {"wink_right", Kind::expression, "AU45R=1 AU6R=0.6 AU12R=0.15", 0.1, 0.2, "the right eye shut"},
    {"brow_raise", Kind::expression, "AU1=1 AU2=1", 0.2, 0.3, "both brows up"},
    {"brow_lower", Kind::expression, "AU4=1", 0.3, 0.4, "both brows down and together"},
    {"nose_wrinkle", Kind::expression, "AU9=1", 0.25, 0.35, ""},
    {"eyes_wide", Kind::expression, "AU5=1", 0.15, 0.3, ""},
    {"eyes_closed", Kind::expression, "AU43=1", 0.2, 0.25, ""},
    {"squint", Kind::expression, "AU6=0.6 AU7=1", 0.25, 0.35, ""},
    {"jaw_drop", Kind::expression, "AU26=1 AU25=0.3", 0.25, 0.3, ""},
    {"mouth_stretch", Kind::expression, "AU27=1 AU25=0.3", 0.3, 0.4, "as wide as the jaw goes"},
    {"a", Kind::viseme, "AU25=0.6 AU26=1", 0, 0, "as in father"},
    {"e", Kind::viseme, "AU12=0.15 AU20=0.45 AU25=0.6 AU26=0.45", 0, 0, "as in bed"},
    {"i", Kind::viseme, "AU12=0.3 AU20=0.55 AU25=0.65 AU26=0.15", 0, 0, "as in see"},
    {"o", Kind::viseme, "AU18=0.6 AU22=0.3 AU25=0.4 AU26=0.6", 0, 0, "as in more"},
    {"u", Kind::viseme, "AU18=0.9 AU22=0.3 AU25=0.3 AU26=0.2", 0, 0, "as in boot"},
    {"m", Kind::viseme, "AU24=0.6", 0, 0, "lips closed: m b p"},
    {"f", Kind::viseme, "AU10=0.2 AU17=0.5 AU26=0.1", 0, 0, "lip to teeth: f v"},
    {"closed", Kind::viseme, "", 0, 0, "mouth at rest: a pause"},
};

/// The number that `text` says, within 0..1.
objdb::Result<double> intensity(std::string_view name, std::string_view text) {
  auto value = objdb::parse_real(text, {});
  if (!value) {
    return Error{value.error().kind, std::string(name) + ": " + value.error().sentence, 0};
  }
  if (!(*value >= 0 && *value <= 1))
    return Error{ErrorKind::range, std::string(name) + " is " + std::string(text) + ", expected 0 to 1", 0};
  return *value;
}

}  // namespace

std::span<const NamedExpression> named_expressions() { return table; }

const NamedExpression* find_expression(std::string_view name) {
  const auto* found = std::find_if(std::begin(table), std::end(table),
                                   [&](const NamedExpression& expression) { return expression.name == name; });
  return found == std::end(table) ? nullptr : found;
}

objdb::Result<Amount> parse_amount(std::string_view word) {
  const auto equals = word.find('=');
  const std::string_view name = word.substr(0, equals);
  if (name.empty()) return Error{ErrorKind::syntax, "expected NAME=AMOUNT, found " + objdb::shown(word), 0};
  if (equals == std::string_view::npos) return Amount{name, 1};
  const auto value = intensity(name, word.substr(equals + 1));
  if (!value) return value.error();
  return Amount{name, *value};
}

objdb::Result<Parts> parse_parts(std::span<const std::string_view> words) {
  std::map<int, double> sum;
  for (std::string_view word : words) {
    const auto amount = parse_amount(word);
    if (!amount) return amount.error();
    if (const auto places = places_of(amount->name)) {
      for (int place : *places) sum[place] += amount->amount;
    } else if (const NamedExpression* known = find_expression(amount->name)) {
      for (const auto& [place, part] : parts_of(*known)) sum[place] += part * amount->amount;
    } else {
      return Error{
          ErrorKind::unknown,
          "no expression or action unit " + objdb::shown(amount->name) + objdb::did_you_mean(amount->name, all_names()),
          0};
    }
  }
  Parts parts;
  for (const auto& [place, level] : sum) parts.emplace_back(place, std::min(level, 1.0));
  return parts;
}

Parts parts_of(const NamedExpression& expression) {
  std::vector<std::string_view> words;
  std::string_view rest = expression.units;
  while (!rest.empty()) {
    const auto blank = rest.find(' ');
    words.push_back(rest.substr(0, blank));
    rest.remove_prefix(blank == std::string_view::npos ? rest.size() : blank + 1);
  }
  auto parts = parse_parts(words);
  assert(parts.ok());
  return *parts;
}

std::vector<std::string_view> all_names() {
  std::vector<std::string_view> names;
  for (const NamedExpression& expression : table) names.push_back(expression.name);
  for (int place = 0; place < 2 * int(action_units().size()); ++place) names.push_back(word_of_place(place));
  return names;
}

}  // namespace face
