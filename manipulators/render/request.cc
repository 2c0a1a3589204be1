#include "manipulators/render/request.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "manipulators/render/look.h"

namespace render {

using objdb::Error;
using objdb::ErrorKind;
using objdb::Object;
using objdb::Result;
using objdb::Word;

namespace {

Result<const Object*> named(const objdb::Database& world, const Word& word, std::string_view type) {
  const Object* object = world.find(word.text);
  if (!object) {
    return Error{ErrorKind::unknown, "no object " + objdb::shown(word.text) + "; expected a " + std::string(type),
                 word.column};
  }
  if (!is_a(world, *object, type)) {
    return Error{ErrorKind::type, object->path + " is a " + object->type->name() + ", expected a " + std::string(type),
                 word.column};
  }
  return object;
}

// a positive number, with or without Hz
Result<double> rate_of(const Word& word) {
  std::string_view text = word.text;
  if (text.ends_with("Hz")) text.remove_suffix(2);
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || !(value >= 0.01 && value <= 1000)) {
    return Error{ErrorKind::range, "the rate must be 0.01 to 1000 pictures a second, is " + objdb::shown(word.text),
                 word.column};
  }
  return value;
}

Result<int> count_of(const Word& word, int most) {
  int value = 0;
  const auto [end, problem] = std::from_chars(word.text.data(), word.text.data() + word.text.size(), value);
  if (problem != std::errc() || end != word.text.data() + word.text.size() || value < 1 || value > most) {
    return Error{ErrorKind::range,
                 "expected a whole number from 1 to " + std::to_string(most) + ", is " + objdb::shown(word.text),
                 word.column};
  }
  return value;
}

}  // namespace

Result<Size> parse_size(const Word& word) {
  Size size;
  const char* end = word.text.data() + word.text.size();
  const auto width = std::from_chars(word.text.data(), end, size.width);
  const bool has_x = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = has_x ? std::from_chars(width.ptr + 1, end, size.height) : width;
  if (!has_x || height.ec != std::errc() || height.ptr != end) {
    return Error{ErrorKind::syntax, "expected a size like 1280x720, is " + objdb::shown(word.text), word.column};
  }
  if (std::string problem = size_problem(size); !problem.empty()) return Error{ErrorKind::range, problem, word.column};
  return size;
}

Result<Request> parse_request(const objdb::Database& world, objdb::Words words,
                              std::initializer_list<std::string_view> allowed) {
  Request request;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Word& word = words[i];
    const bool is_keyword = !word.quoted && std::find(allowed.begin(), allowed.end(), word.text) != allowed.end();
    if (!is_keyword) {
      request.files.emplace_back(word.text);
      continue;
    }
    if (i + 1 == words.size()) {
      return Error{ErrorKind::syntax, "expected a word after " + std::string(word.text), word.column};
    }
    const Word& value = words[++i];
    if (word.text == "from") {
      auto camera = named(world, value, "camera");
      if (!camera) return camera.error();
      request.camera = *camera;
    } else if (word.text == "with") {
      auto view = named(world, value, "view");
      if (!view) return view.error();
      request.view = *view;
    } else if (word.text == "size") {
      auto size = parse_size(value);
      if (!size) return size.error();
      request.size = *size;
    } else if (word.text == "rate") {
      auto rate = rate_of(value);
      if (!rate) return rate.error();
      request.rate = *rate;
    } else if (word.text == "columns") {
      auto columns = count_of(value, 100);
      if (!columns) return columns.error();
      request.columns = *columns;
    } else {
      static constexpr std::string_view names[] = {"draft", "good", "best"};
      const auto found = std::find(std::begin(names), std::end(names), value.text);
      if (found == std::end(names)) {
        return Error{ErrorKind::range, "quality must be draft, good or best, is " + objdb::shown(value.text),
                     value.column};
      }
      request.quality = static_cast<Quality>(found - std::begin(names));
    }
  }
  if (!request.view) {
    const auto views = all_of(world, "view");
    if (!views.empty()) request.view = views.front();
  }
  return request;
}

}  // namespace render
