#include "dialog_manager/screen_text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cwchar>

namespace manager {

std::size_t width(std::string_view text) {
  std::size_t columns = 0;
  std::mbstate_t state{};
  while (!text.empty()) {
    wchar_t character = 0;
    const std::size_t bytes = std::mbrtowc(&character, text.data(), text.size(), &state);
    if (bytes == 0 || bytes > text.size()) {
      state = {};
      text.remove_prefix(1);
      columns += 2;
      continue;
    }
    const int each = ::wcwidth(character);
    columns += each < 0 ? 2 : static_cast<std::size_t>(each);
    text.remove_prefix(bytes);
  }
  return columns;
}

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  if (::isatty(descriptor) == 0) return 0;
  // a terminal that does not know is as wide as terminals were
  constexpr std::size_t usual = 80;
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : usual;
}

std::string wrapped(std::string_view text, std::size_t columns) {
  if (columns == 0) return std::string(text);
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string indent(line.substr(0, std::min(line.find_first_not_of(' '), line.size())));
    line.remove_prefix(indent.size());
    out += indent;
    std::size_t used = indent.size();
    bool first = true;
    while (!line.empty()) {
      const std::size_t blank = std::min(line.find(' '), line.size());
      const std::string_view word = line.substr(0, blank);
      line.remove_prefix(std::min(blank + 1, line.size()));
      if (!first && used + 1 + width(word) > columns) {
        out.append("\n").append(indent);
        used = indent.size();
        first = true;
      }
      if (!first) out += " ";
      used += width(word) + (first ? 0 : 1);
      out += word;
      first = false;
    }
    out += "\n";
  }
  return out;
}

std::string in_columns(const std::vector<std::string>& words, std::size_t columns, std::size_t rows) {
  constexpr std::size_t gap = 2;
  std::size_t widest = 1;
  for (const std::string& word : words) widest = std::max(widest, width(word));
  const std::size_t across = std::max<std::size_t>(1, (columns + gap) / (widest + gap));
  const std::size_t shown = std::min(words.size(), across * rows);
  const std::size_t down = (shown + across - 1) / across;
  std::string out;
  for (std::size_t row = 0; row < down; ++row) {
    for (std::size_t i = row; i < shown; i += down) {
      out += words[i];
      if (i + down < shown) out.append(widest + gap - width(words[i]), ' ');
    }
    out += "\n";
  }
  if (shown < words.size()) out += "... and " + std::to_string(words.size() - shown) + " more\n";
  return out;
}

}  // namespace manager
