#include <cstdlib>
#include <string>

#include "objdb/text.h"

/// Any bytes as one line: split, quoted again and split again, the words must be the same.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace objdb;
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  LineWords words;
  if (const Status status = words.split(line); !status) {
    if (status.error().column < 1 || status.error().column > static_cast<int>(size) ||
        !is_text(status.error().sentence))
      std::abort();
    return 0;
  }
  std::string again = words.tag().empty() ? std::string() : "@" + std::string(words.tag()) + " ";
  for (const Word& word : words.words()) {
    // a bare word stands where its column says
    if (!word.quoted && line.substr(static_cast<std::size_t>(word.column) - 1, word.text.size()) != word.text)
      std::abort();
    append_quoted(again, word.text);
    again += ' ';
  }
  LineWords twice;
  if (!twice.split(again) || twice.words().size() != words.words().size() || twice.tag() != words.tag()) std::abort();
  for (std::size_t i = 0; i < words.words().size(); ++i)
    if (words.words()[i].text != twice.words()[i].text) std::abort();
  return 0;
}
