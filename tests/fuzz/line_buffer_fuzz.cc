#include "dialog_manager/channel/line_buffer.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace {

using channel::LineBuffer;
using Next = LineBuffer::Next;
using Lines = std::vector<std::pair<Next, std::string>>;

void require(bool good) {
  if (!good) std::abort();
}

// all lines of a text that arrives in pieces of `piece` bytes
Lines read(std::string_view text, std::size_t longest, std::size_t piece) {
  LineBuffer buffer(longest);
  Lines out;
  while (true) {
    std::string_view line;
    const Next next = buffer.next(line);
    if (next == Next::end) break;
    if (next == Next::none) {
      const std::size_t count = std::min(piece, text.size());
      if (count == 0) {
        buffer.close();
        continue;
      }
      std::memcpy(buffer.room(count), text.data(), count);
      buffer.fill(count);
      text.remove_prefix(count);
      // never more than a line and a piece is kept
      require(buffer.pending() <= longest + count && buffer.rest().size() == buffer.pending());
      continue;
    }
    // of a line that is too long only the beginning is given, as much as had come
    out.emplace_back(next, next == Next::too_long ? "" : line);
  }
  return out;
}

// the same, as plainly as it can be said
Lines expected(std::string_view text, std::size_t longest) {
  Lines out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    const bool half = end == std::string_view::npos;
    if (half ? line.size() >= longest : line.size() + 1 > longest)
      out.emplace_back(Next::too_long, "");
    else
      out.emplace_back(half ? Next::half : Next::line, line);
    text.remove_prefix(half ? text.size() : end + 1);
  }
  return out;
}

}  // namespace

/// First byte: the longest line. Second: how many bytes come at a time. The rest: what comes. Lines do not depend on
/// how they were cut into pieces.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t longest = data[0] % 40 + 1u, piece = data[1] % 50 + 1u;
  const std::string_view text(reinterpret_cast<const char*>(data) + 2, size - 2);
  require(read(text, longest, piece) == expected(text, longest));
  return 0;
}
