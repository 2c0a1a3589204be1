#include "dialog_manager/said_error.h"

#include <algorithm>
#include <string>

#include "dialog_manager/count.h"

namespace manager {

using namespace objdb;

Error parse_said_error(std::string_view text) {
  text.remove_prefix(std::min<std::size_t>(6, text.size()));
  Error error{ErrorKind::io, std::string(text), 0};
  for (int kind = 0; kind <= static_cast<int>(ErrorKind::io); ++kind) {
    const std::string_view word = name_of(static_cast<ErrorKind>(kind));
    if (!text.starts_with(word) || text.size() <= word.size() || text[word.size()] != ' ') continue;
    error.kind = static_cast<ErrorKind>(kind);
    error.sentence = text.substr(word.size() + 1);
    // an optional column of the forwarded line
    const std::size_t digits = error.sentence.find_first_not_of("0123456789");
    if (digits != 0 && digits != std::string::npos && error.sentence[digits] == ' ') {
      error.column = static_cast<int>(parse_count(std::string_view(error.sentence).substr(0, digits)).value_or(0));
      error.sentence.erase(0, digits + 1);
    }
    break;
  }
  return error;
}

}  // namespace manager
