#include "dialog_manager/number_word.h"

namespace manager {

using namespace objdb;

Result<std::uint64_t> count_word(const Call& call, std::size_t index, std::uint64_t missing) {
  if (index >= call.words.size()) return missing;
  const Result<std::int64_t> count = parse_integer(call.words[index].text);
  if (!count) return call.error(static_cast<int>(index), count.error().kind, count.error().sentence);
  if (*count < 1)
    return call.error(static_cast<int>(index), ErrorKind::range,
                      "the count is " + std::to_string(*count) + ", expected at least 1");
  return static_cast<std::uint64_t>(*count);
}

Result<double> real_word(const Call& call, std::size_t index, std::string_view unit) {
  Result<double> value = parse_real(call.words[index].text, parse_unit(unit)->dimension);
  if (!value) return call.error(static_cast<int>(index), value.error().kind, value.error().sentence);
  return value;
}

}  // namespace manager
