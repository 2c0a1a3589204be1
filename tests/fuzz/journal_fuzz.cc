#include <cstdlib>
#include <string>

#include "dialog_manager/journal.h"
#include "objdb/text.h"
#include "objdb/value.h"

namespace {

void require(bool good) {
  if (!good) std::abort();
}

// the check that a line must carry, so that the reader behind it is reached
std::string with_checks(std::string_view text) {
  std::string out;
  std::uint64_t check = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    check = objdb::hash_text(line, check) & 0xffffffffu;
    objdb::append_hexadecimal(out, check, 8);
    out.append(" ").append(line);
    if (end != std::string_view::npos) out += '\n';
  }
  return out;
}

void read(const std::string& bytes) {
  const objdb::Result<manager::JournalText> text = manager::parse_journal(bytes);
  if (!text) return;
  require(text->good <= bytes.size());
  // what is good is a journal of its own, with the same records and no flaw
  const objdb::Result<manager::JournalText> good = manager::parse_journal(bytes.substr(0, text->good));
  require(good.ok() && good->flaw.empty() && good->good == text->good && good->check == text->check);
  require(good->records.size() == text->records.size());
  for (std::size_t i = 0; i < good->records.size(); ++i) {
    const manager::Record &a = text->records[i], &b = good->records[i];
    require(a.tick == b.tick && a.source == b.source && a.prefix == b.prefix && a.line == b.line);
  }
}

}  // namespace

/// Any bytes as a journal. First byte odd: the rest gets the checks it needs; even: it is read as it stands.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  read(data[0] % 2 == 1 ? with_checks(text) : text);
  return 0;
}
