#include "dialog_manager/prompt.h"

#include <fcntl.h>
#include <histedit.h>
#include <langinfo.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

#include "dialog_manager/channel/loop.h"
#include "dialog_manager/screen_text.h"

namespace manager {
namespace {

constexpr std::size_t history_length = 2000;

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

// characters of a text in UTF-8
int characters(std::string_view text) {
  return static_cast<int>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// The lines of earlier sessions, one a line in a file that only its owner reads. A line is kept when it is entered, so
/// that none is lost with a session that is killed, and those of sessions side by side all are.
class Past {
 public:
  Past() : history_(::history_init()) { ::history(history_, &event_, H_SETSIZE, static_cast<int>(history_length)); }
  ~Past() {
    ::history_end(history_);
    if (file_ >= 0) ::close(file_);
  }
  Past(const Past&) = delete;
  Past& operator=(const Past&) = delete;

  ::History* history() { return history_; }

  void open(const std::string& path) {
    std::vector<std::string> lines;
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) lines.push_back(std::move(line));
    const std::size_t first = lines.size() > history_length ? lines.size() - history_length : 0;
    for (std::size_t i = first; i < lines.size(); ++i) remember(lines[i]);
    // shortened now and then, not at every start
    const bool shorten = lines.size() > 2 * history_length;
    file_ =
        ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | (shorten ? O_TRUNC : 0), 0600);
    if (shorten)
      for (std::size_t i = first; i < lines.size(); ++i) write(lines[i]);
  }

  void add(const std::string& line) {
    if (line.empty() || line == last_) return;
    remember(line);
    write(line);
  }

 private:
  void remember(const std::string& line) {
    ::history(history_, &event_, H_ENTER, line.c_str());
    last_ = line;
  }
  // whole or not at all, also with another session at the same file
  void write(const std::string& line) const {
    if (file_ < 0) return;
    const std::string text = line + "\n";
    [[maybe_unused]] const ssize_t written = ::write(file_, text.data(), text.size());
  }

  ::History* history_;
  ::HistEvent event_{};
  std::string last_;
  int file_ = -1;
};

// what the library does not bind by itself: the keys of other terminals, and going back to what began like this
constexpr const char* bindings[][2] = {
    {"^I", "complete"},
    {"^R", "em-inc-search-prev"},
    {"^W", "ed-delete-prev-word"},
    {"\\e[A", "ed-search-prev-history"},
    {"\\eOA", "ed-search-prev-history"},
    {"\\e[B", "ed-search-next-history"},
    {"\\eOB", "ed-search-next-history"},
    {"\\e[H", "ed-move-to-beg"},
    {"\\eOH", "ed-move-to-beg"},
    {"\\e[1~", "ed-move-to-beg"},
    {"\\e[7~", "ed-move-to-beg"},
    {"\\e[F", "ed-move-to-end"},
    {"\\eOF", "ed-move-to-end"},
    {"\\e[4~", "ed-move-to-end"},
    {"\\e[8~", "ed-move-to-end"},
    {"\\e[3~", "ed-delete-next-char"},
    {"\\e[1;5C", "em-next-word"},
    {"\\e[1;5D", "ed-prev-word"},
};

}  // namespace

struct Prompt::Impl {
  Complete complete;
  std::unique_ptr<channel::ReadyWatch> keys;
  int read_end = -1, write_end = -1;
  Past past;
  EditLine* editor = nullptr;
  bool visible = false, continues = false;
  std::string kept;    // typed before hide()
  int kept_after = 0;  // characters of it behind the cursor
  std::string entered_last;
  bool entered_alone = false;  // it stands on one row, and is a line of its own

  const char* mark() const { return continues ? "...> " : "> "; }

  static Impl& of(EditLine* editor) {
    void* self = nullptr;
    ::el_get(editor, EL_CLIENTDATA, &self);
    return *static_cast<Impl*>(self);
  }

  // the text, and as much of it as stands before the cursor
  std::pair<std::string, std::string> typed() const {
    const LineInfo* line = ::el_line(editor);
    return {std::string(line->buffer, line->lastchar), std::string(line->buffer, line->cursor)};
  }
  // rows below the prompt's that a text reaches
  std::size_t row(const std::string& text) const {
    return (width(mark()) + width(text)) / std::max<std::size_t>(1, terminal_columns(STDOUT_FILENO));
  }

  void take_keys() {
    visible = true;
    ::el_set(editor, EL_UNBUFFERED, 1);
  }
  void leave_keys() {
    visible = false;
    ::el_set(editor, EL_UNBUFFERED, 0);
  }

  // below all of what is typed; the library draws it again underneath
  void print_below(const std::string& text) const {
    const auto [all, before] = typed();
    print(std::string(row(all) - row(before) + 1, '\n') + text);
    ::el_set(editor, EL_REFRESH);
  }

  unsigned char complete_word() {
    const std::string before = typed().second;
    Completion found = complete(before);
    if (found.words.empty()) {
      if (found.hint.empty()) return CC_ERROR;
      print_below("  " + found.hint + "\n");
      return CC_NORM;
    }
    std::string common = found.words[0];
    for (const std::string& each : found.words)
      common.resize(static_cast<std::size_t>(
          std::mismatch(common.begin(), common.end(), each.begin(), each.end()).first - common.begin()));
    const std::size_t length = before.size() - found.start;
    if (common.size() > length) {
      ::el_insertstr(editor, common.substr(length).c_str());
      return CC_REFRESH;
    }
    if (found.words.size() == 1) return CC_ERROR;
    for (std::string& each : found.words) each.erase(0, found.hidden);
    constexpr std::size_t rows = 20;
    print_below(in_columns(found.words, terminal_columns(STDOUT_FILENO), rows));
    return CC_NORM;
  }

  void key() {
    int count = 0;
    const char* text = ::el_gets(editor, &count);
    if (text == nullptr) {
      // an empty line, or nobody is there any more
      pollfd terminal{STDIN_FILENO, POLLIN, 0};
      if (::poll(&terminal, 1, 0) > 0 && (terminal.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) end();
      return;
    }
    constexpr char end_of_file = 4;
    if (count == 1 && text[0] == end_of_file) {
      end();
    } else if (text[count - 1] == '\n' || text[count - 1] == '\r') {
      enter(std::string(text, static_cast<std::size_t>(count) - 1));
    }
  }

  void end() {
    leave_keys();
    print("\n");
    ::close(write_end);
    write_end = -1;
  }

  void enter(std::string line) {
    leave_keys();
    std::fflush(stdout);
    past.add(line);
    entered_last = line;
    entered_alone = !continues && row(line) == 0;
    line += '\n';
    const char* rest = line.data();
    for (std::size_t left = line.size(); left > 0;) {
      const ssize_t written = ::write(write_end, rest, left);
      if (written <= 0) break;
      rest += written;
      left -= static_cast<std::size_t>(written);
    }
  }
};

Prompt::Prompt(channel::Loop& loop, Complete complete) : impl_(std::make_unique<Impl>()) {
  impl_->complete = std::move(complete);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) == 0) {
    impl_->read_end = ends[0];
    impl_->write_end = ends[1];
    // the longest line there is fits, so that writing it never waits for ourselves
    constexpr int room = 1 << 20;
    ::fcntl(impl_->write_end, F_SETPIPE_SZ, room);
  }
  // characters are UTF-8 wherever this runs; numbers keep their point
  if (std::setlocale(LC_CTYPE, "") == nullptr || std::strcmp(::nl_langinfo(CODESET), "UTF-8") != 0)
    std::setlocale(LC_CTYPE, "C.UTF-8");
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    impl_->past.open(std::string(home) + "/.dialog_manager_history");

  impl_->editor = ::el_init("dialog_manager", stdin, stdout, stderr);
  EditLine* editor = impl_->editor;
  ::el_set(editor, EL_CLIENTDATA, impl_.get());
  ::el_set(editor, EL_SIGNAL, 0);
  ::el_set(editor, EL_EDITOR, "emacs");
  ::el_set(editor, EL_HIST, ::history, impl_->past.history());
  ::el_set(
      editor, EL_PROMPT, +[](EditLine* of) { return const_cast<char*>(Impl::of(of).mark()); });
  ::el_set(
      editor, EL_ADDFN, "complete", "what may stand here",
      +[](EditLine* of, int) { return Impl::of(of).complete_word(); });
  for (const auto& [key, action] : bindings) ::el_set(editor, EL_BIND, key, action, nullptr);
  // ~/.editrc: other bindings, vi
  ::el_source(editor, nullptr);

  impl_->keys = std::make_unique<channel::ReadyWatch>(loop, STDIN_FILENO, [this] {
    if (impl_->visible) impl_->key();
    if (impl_->visible) impl_->keys->want();
  });
}

Prompt::~Prompt() {
  if (impl_->visible) hide();
  ::el_end(impl_->editor);
  if (impl_->write_end >= 0) ::close(impl_->write_end);
  if (impl_->read_end >= 0) ::close(impl_->read_end);
}

int Prompt::reader() { return std::exchange(impl_->read_end, -1); }

bool Prompt::visible() const { return impl_->visible; }

void Prompt::show(bool continues) {
  if (impl_->visible || impl_->write_end < 0) return;
  impl_->continues = continues;
  impl_->take_keys();
  if (!impl_->kept.empty()) {
    ::el_insertstr(impl_->editor, impl_->kept.c_str());
    ::el_cursor(impl_->editor, -impl_->kept_after);
    print("\r");
    ::el_set(impl_->editor, EL_REFRESH);
    impl_->kept.clear();
  }
  impl_->keys->want();
}

void Prompt::hide() {
  if (!impl_->visible) return;
  const auto [all, before] = impl_->typed();
  impl_->kept = all;
  impl_->kept_after = characters(std::string_view(all).substr(before.size()));
  // back to the prompt, and nothing from there on
  const std::size_t up = impl_->row(before);
  print("\r" + (up > 0 ? "\033[" + std::to_string(up) + "A" : "") + "\033[J");
  impl_->leave_keys();
}

void Prompt::cancel() {
  if (!impl_->visible) return;
  const auto [all, before] = impl_->typed();
  print(std::string(impl_->row(all) - impl_->row(before), '\n') + "^C\n");
  impl_->leave_keys();
  impl_->kept.clear();
}

void Prompt::redraw() {
  const bool shown = impl_->visible;
  if (shown) hide();
  ::el_resize(impl_->editor);
  if (shown) show(impl_->continues);
}

std::optional<std::size_t> Prompt::place(int column) const {
  const std::string& line = impl_->entered_last;
  if (!impl_->entered_alone || column < 1 || static_cast<std::size_t>(column) > line.size() + 1) return std::nullopt;
  return width(impl_->mark()) + width(std::string_view(line).substr(0, static_cast<std::size_t>(column) - 1));
}

}  // namespace manager
