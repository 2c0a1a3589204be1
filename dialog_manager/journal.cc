#include "dialog_manager/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "objdb/text.h"
#include "objdb/unit.h"
#include "objdb/value.h"

namespace manager {
namespace {

using namespace objdb;

constexpr std::size_t ahead = 256 * 1024;
constexpr std::string_view heading = "sailor-journal 1";

// 32 bits over a line and, through `before`, over all lines before it
std::uint64_t check_of(std::uint64_t before, std::string_view text) { return hash_text(text, before) & 0xffffffffu; }

void write_hex(char* out, std::uint64_t value) {
  static constexpr char digits[] = "0123456789abcdef";
  for (int shift = 28; shift >= 0; shift -= 4) *out++ = digits[(value >> shift) & 15];
}

Error io_error(const std::string& path, std::string_view what) {
  return {ErrorKind::io,
          "journal " + path + " " + std::string(what) + (errno == 0 ? "" : std::string(": ") + std::strerror(errno)),
          0};
}

// a journal is begun anew over an old one; any other file that has something in it is kept from a slip of the tongue
bool may_begin(int file) {
  std::array<char, 9 + heading.size()> start;
  const ssize_t count = ::pread(file, start.data(), start.size(), 0);
  return count == 0 ||
         (count == static_cast<ssize_t>(start.size()) && std::string_view(start.data() + 9, heading.size()) == heading);
}

// "TICK SOURCE PREFIX LINE"; names in quotes are kept aside
bool parse_record(std::string_view text, Record& record, std::deque<std::string>& names) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), record.tick);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  for (std::string_view* word : {&record.source, &record.prefix}) {
    if (text.empty() || text[0] != ' ') return false;
    text.remove_prefix(1);
    std::size_t length = text.find(' ');
    const bool quoted = !text.empty() && text[0] == '"';
    if (quoted) {
      for (length = 1; length < text.size() && text[length] != '"'; ++length)
        if (text[length] == '\\') ++length;
      ++length;
    }
    if (length == std::string_view::npos || length == 0 || length > text.size()) return false;
    *word = text.substr(0, length);
    if (quoted) {
      LineWords words;
      if (Status split = words.split(*word); !split || words.words().size() != 1) return false;
      *word = names.emplace_back(words.words()[0].text);
    }
    text.remove_prefix(length);
  }
  if (record.prefix == "-") record.prefix = {};
  if (text.empty() || text[0] != ' ') return false;
  record.line = text.substr(1);
  return true;
}

bool parse_start(std::string_view text, JournalStart& start) {
  LineWords words;
  if (Status split = words.split(text); !split || (words.words().size() != 6 && words.words().size() != 8))
    return false;
  const Words all = words.words();
  if (std::string(all[0].text) + " " + std::string(all[1].text) != heading) return false;
  const auto value = [&](std::size_t index, std::string_view key) -> std::string_view {
    return all[index].text.starts_with(key) ? all[index].text.substr(key.size()) : std::string_view();
  };
  const Result<std::int64_t> tick = parse_integer(value(2, "tick="));
  const Result<double> time = parse_real(value(3, "time="), {}), rate = parse_real(value(4, "rate="), {});
  const std::string_view seed = value(5, "seed=");
  const bool computed = all.size() == 8;
  const Result<std::int64_t> base_tick = parse_integer(computed ? value(6, "base_tick=") : value(2, "tick="));
  const Result<double> base_time = parse_real(computed ? value(7, "base_time=") : value(3, "time="), {});
  if (!base_tick || !base_time || *base_tick < 0) return false;
  start.base_tick = static_cast<std::uint64_t>(*base_tick);
  start.base_time = *base_time;
  if (!tick || !time || !rate || *tick < 0 || !(*rate > 0)) return false;
  start.tick = static_cast<std::uint64_t>(*tick);
  start.time = *time;
  start.rate = *rate;
  return std::from_chars(seed.data(), seed.data() + seed.size(), start.seed).ec == std::errc();
}

}  // namespace

Result<std::unique_ptr<Journal>> Journal::open(const std::string& path, Sync sync, int flags) {
  std::unique_ptr<Journal> journal(new Journal);
  journal->path_ = path;
  journal->sync_ = sync;
  journal->file_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | flags, 0600);
  if (journal->file_ < 0) return io_error(path, "cannot be opened");
  struct stat status {};
  ::fstat(journal->file_, &status);
  errno = 0;
  if (!S_ISREG(status.st_mode)) return io_error(path, "is no regular file");
  if (status.st_uid != ::geteuid() || (status.st_mode & 022) != 0)
    return io_error(path, "can be written by others, expected a file of ours, mode 0600");
  if (::flock(journal->file_, LOCK_EX | LOCK_NB) != 0)
    return Error{ErrorKind::busy, "journal " + path + " is written by another manager", 0};
  return journal;
}

Result<std::unique_ptr<Journal>> Journal::create(const std::string& path, Sync sync, const JournalStart& start) {
  Result<std::unique_ptr<Journal>> journal = open(path, sync, O_CREAT);
  if (!journal) return journal;
  if (!may_begin((*journal)->file_))
    return Error{ErrorKind::exists, "journal " + path + " is another file, expected a new one or a journal", 0};
  if (::fchmod((*journal)->file_, 0600) != 0) return io_error(path, "cannot be kept from others");
  if (::ftruncate((*journal)->file_, 0) != 0) return io_error(path, "cannot be emptied");
  // arrays of a journal that stood here before
  ::unlink(ArrayFile::path_of(path).c_str());
  std::string first = std::string(heading) + " tick=" + std::to_string(start.tick) + " time=" + number(start.time) +
                      " rate=" + number(start.rate) + " seed=" + std::to_string(start.seed);
  // a time is computed from the last change of the rate: taken up elsewhere, it would differ in its last bit
  if (start.base_tick != start.tick)
    first += " base_tick=" + std::to_string(start.base_tick) + " base_time=" + number(start.base_time);
  if (Status room = (*journal)->reserve(first.size() + 16); !room) return room.error();
  (*journal)->check_ = check_of(0, first);
  (*journal)->buffer_.resize(8);
  write_hex((*journal)->buffer_.data(), (*journal)->check_);
  (*journal)->buffer_ += " " + first + "\n";
  if (Status kept = (*journal)->flush(true); !kept) return kept.error();
  return journal;
}

Result<std::unique_ptr<Journal>> Journal::resume(const std::string& path, Sync sync, std::size_t good,
                                                 std::uint64_t check) {
  Result<std::unique_ptr<Journal>> journal = open(path, sync, 0);
  if (!journal) return journal;
  if (::ftruncate((*journal)->file_, static_cast<off_t>(good)) != 0)
    return io_error(path, "cannot be cut to its last whole line");
  ::lseek((*journal)->file_, 0, SEEK_END);
  (*journal)->size_ = (*journal)->reserved_ = good;
  (*journal)->check_ = check;
  return journal;
}

Journal::~Journal() {
  if (file_ < 0) return;
  (void)flush(true);
  // what was reserved and not used is given back
  if (reserved_ > size_ && ::ftruncate(file_, static_cast<off_t>(size_)) == 0) reserved_ = size_;
  ::close(file_);
}

Status Journal::reserve(std::size_t bytes) {
  const std::size_t needed = size_ + buffer_.size() + bytes;
  if (needed <= reserved_) return {};
  // room for many lines at once; on a disk that is nearly full, for this one
  for (const std::size_t wanted : {needed + ahead, needed}) {
    const int error = ::posix_fallocate(file_, static_cast<off_t>(size_), static_cast<off_t>(wanted - size_));
    if (error == 0) {
      reserved_ = wanted;
      return {};
    }
    errno = error;
  }
  return io_error(path_, "cannot grow");
}

Status Journal::reserve_tick() {
  constexpr std::size_t closing_line = 4096;
  tick_start_ = size_ + buffer_.size();
  return reserve(2 * longest_tick_ + closing_line);
}

Result<std::string> Journal::add_array(const Numbers& numbers) {
  if (!arrays_) {
    Result<std::unique_ptr<ArrayFile>> opened = ArrayFile::open(ArrayFile::path_of(path_));
    if (!opened) return opened.error();
    arrays_ = std::move(*opened);
  }
  return arrays_->add(numbers);
}

void Journal::add(std::uint64_t tick, std::string_view source, std::string_view prefix, std::string_view line) {
  const std::size_t start = buffer_.size();
  buffer_ += "........ ";
  append_number(buffer_, static_cast<std::int64_t>(tick));
  buffer_ += ' ';
  append_quoted(buffer_, source);
  buffer_ += ' ';
  if (prefix.empty())
    buffer_ += '-';
  else
    append_quoted(buffer_, prefix);
  buffer_ += ' ';
  buffer_ += line;
  check_ = check_of(check_, std::string_view(buffer_).substr(start + 9));
  write_hex(buffer_.data() + start, check_);
  buffer_ += '\n';
}

Status Journal::flush(bool tick_ended) {
  if (tick_ended && tick_start_) {
    longest_tick_ = std::max(longest_tick_, size_ + buffer_.size() - *tick_start_);
    tick_start_.reset();
  }
  std::string_view rest = buffer_;
  while (!rest.empty() && kept_) {
    const ssize_t count = ::pwrite(file_, rest.data(), rest.size(), static_cast<off_t>(size_));
    if (count < 0 && errno == EINTR) continue;
    // room was reserved before anything was accepted: this is a disk that breaks
    if (count < 0) {
      kept_ = io_error(path_, "cannot be written");
      break;
    }
    size_ += static_cast<std::size_t>(count);
    rest.remove_prefix(static_cast<std::size_t>(count));
    unsynced_ = true;
  }
  buffer_.erase(0, buffer_.size() - rest.size());
  if (!unsynced_ || !kept_) return kept_;
  const auto now = std::chrono::steady_clock::now();
  const bool due = sync_ == Sync::always || (sync_ == Sync::tick && tick_ended) ||
                   (sync_ == Sync::everysec && now - synced_at_ > std::chrono::seconds(1));
  if (!due) return kept_;
  // after a failure the system may have dropped what it could not write: to ask again would be answered falsely
  if ((arrays_ && !arrays_->sync()) || ::fdatasync(file_) != 0)
    kept_ = io_error(path_, "cannot be written to its disk");
  synced_at_ = now;
  unsynced_ = false;
  return kept_;
}

Result<JournalText> parse_journal(std::string bytes) {
  JournalText out;
  out.text = std::make_shared<const std::string>(std::move(bytes));
  out.names = std::make_shared<std::deque<std::string>>();
  const std::string_view text = *out.text;
  // the shortest record has 17 bytes; a file of empty lines is no journal
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  out.records.reserve(std::min(lines, text.size() / 17));
  std::uint64_t check = 0;
  std::size_t at = 0;
  bool first = true;
  std::uint64_t tick = 0;
  std::size_t whole = 0;  // records that stand; what comes behind them is of a tick that has not ended yet
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    const std::string_view line = text.substr(at, end == std::string_view::npos ? end : end - at);
    // an unused reserve is nothing but zeros
    if (!line.empty() && line[0] == '\0') break;
    std::uint64_t said = 0;
    const bool framed = end != std::string_view::npos && line.size() > 9 && line[8] == ' ' &&
                        std::from_chars(line.data(), line.data() + 8, said, 16).ptr == line.data() + 8;
    const std::string_view body = framed ? line.substr(9) : std::string_view();
    check = check_of(first ? 0 : check, body);
    Record record;
    if (!framed || said != check || (first ? !parse_start(body, out.start) : !parse_record(body, record, *out.names))) {
      if (first) break;
      out.flaw = "byte " + std::to_string(at) + ": the line is torn or was changed";
      break;
    }
    at = end + 1;
    if (first) {
      first = false;
      tick = out.start.tick;
    } else {
      out.records.push_back(record);
      if (record.source == tick_source)
        tick = record.tick;
      else if (record.tick > tick)
        continue;
      // a line between ticks after a tick that was begun: that tick was broken off, and its lines stand
      whole = out.records.size();
    }
    out.good = at;
    out.check = check;
  }
  if (first) return Error{ErrorKind::io, "is no journal", 0};
  if (out.flaw.empty() && whole < out.records.size()) out.flaw = "tick " + std::to_string(tick + 1) + " is not whole";
  out.records.resize(whole);
  return out;
}

Result<JournalText> read_journal(const std::string& path) {
  // a pipe or a device is no journal, and reading one may never end
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    errno = 0;
    return io_error(path, "is no regular file");
  }
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file.is_open()) {
    errno = 0;
    return io_error(path, "cannot be read");
  }
  std::string bytes(static_cast<std::size_t>(std::max<std::streamoff>(file.tellg(), 0)), '\0');
  file.seekg(0);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  Result<JournalText> text = parse_journal(std::move(bytes));
  errno = 0;
  if (!text) return io_error(path, text.error().sentence);
  text->path = path;
  return text;
}

}  // namespace manager
