#include "dialog_manager/put_words.h"

#include "dialog_manager/count.h"

namespace manager {

using namespace objdb;

Status parse_put(Words words, std::uint64_t& slot, std::uint64_t& sequence) {
  const bool whole = words.size() == 4;
  const auto said_slot = whole ? parse_count_of("slot=", words[2].text) : std::nullopt;
  const auto said_sequence = whole ? parse_count_of("seq=", words[3].text) : std::nullopt;
  if (!said_slot || !said_sequence)
    return Error{ErrorKind::syntax, "expected put PATH.FIELD slot=K seq=N", words.back().column};
  slot = *said_slot;
  sequence = *said_sequence;
  return {};
}

}  // namespace manager
