#include "dialog_manager/put_words.h"

#include <charconv>

namespace manager {
namespace {

using namespace objdb;

bool parse_word(std::string_view word, std::string_view key, std::uint64_t& value) {
  if (!word.starts_with(key)) return false;
  word.remove_prefix(key.size());
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

Status parse_put(Words words, std::uint64_t& slot, std::uint64_t& sequence) {
  if (words.size() != 4 || !parse_word(words[2].text, "slot=", slot) || !parse_word(words[3].text, "seq=", sequence))
    return Error{ErrorKind::syntax, "expected put PATH.FIELD slot=K seq=N", words.back().column};
  return {};
}

}  // namespace manager
