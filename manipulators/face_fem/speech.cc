#include "manipulators/face_fem/speech.h"

#include <algorithm>

#include "objdb/text.h"
#include "objdb/unit.h"

namespace face {
namespace {

using objdb::Error;
using objdb::ErrorKind;

std::vector<std::string_view> visemes() {
  std::vector<std::string_view> names;
  for (const NamedExpression& expression : named_expressions())
    if (expression.kind == NamedExpression::Kind::viseme) names.push_back(expression.name);
  return names;
}

struct Sound {
  const NamedExpression* viseme;
  double length;
};

objdb::Result<Sound> sound(std::string_view word, double length) {
  const auto equals = word.find('=');
  const std::string_view name = word.substr(0, equals);
  const NamedExpression* viseme = find_expression(name);
  if (viseme == nullptr || viseme->kind != NamedExpression::Kind::viseme)
    return Error{ErrorKind::unknown, "no viseme " + objdb::shown(name) + objdb::did_you_mean(name, visemes()), 0};
  if (equals != std::string_view::npos) {
    const auto value = objdb::parse_real(word.substr(equals + 1), objdb::parse_unit("s")->dimension);
    if (!value) return Error{value.error().kind, std::string(name) + ": " + value.error().sentence, 0};
    length = *value;
  }
  if (!(length > 0))
    return Error{ErrorKind::range, std::string(word) + ": the length of a viseme must be more than 0", 0};
  return Sound{viseme, length};
}

}  // namespace

objdb::Result<std::vector<Gesture>> utterance(std::span<const std::string_view> words, double length, double amount,
                                              double blend) {
  std::vector<Sound> sounds;
  for (std::string_view word : words) {
    const auto found = sound(word, length);
    if (!found) return found.error();
    sounds.push_back(*found);
  }
  if (sounds.empty()) return Error{ErrorKind::syntax, "expected visemes, such as m a m a", 0};
  // what is faded over at the border before sound k; the mouth comes from rest and goes back to it
  const auto fade = [&](std::size_t k) {
    if (k == 0) return blend * sounds.front().length;
    if (k == sounds.size()) return blend * sounds.back().length;
    return blend * std::min(sounds[k - 1].length, sounds[k].length);
  };
  std::vector<Gesture> gestures;
  double border = fade(0) / 2;
  for (std::size_t k = 0; k < sounds.size(); ++k) {
    Gesture gesture;
    gesture.channel = "speech";
    gesture.amount = amount;
    gesture.parts = parts_of(*sounds[k].viseme);
    gesture.envelope.begin = border - fade(k) / 2;
    gesture.envelope.onset = fade(k);
    border += sounds[k].length;
    gesture.envelope.end = border - fade(k + 1) / 2;
    gesture.envelope.offset = fade(k + 1);
    gestures.push_back(std::move(gesture));
  }
  return gestures;
}

}  // namespace face
