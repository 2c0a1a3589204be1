#include "dialog_manager/prompt.h"

#include <editline/readline.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "dialog_manager/channel/loop.h"

namespace manager {

struct Prompt::Impl {
  Complete complete;
  std::unique_ptr<channel::ReadyWatch> keys;
  int read_end = -1, write_end = -1;
  std::string history_file;
  std::string kept;  // typed before hide()
  bool visible = false;
  std::vector<std::string> found;  // completions being given out

  void entered(char* line) {
    rl_callback_handler_remove();
    visible = false;
    if (line == nullptr) {
      std::fputs("\n", stdout);
      std::fflush(stdout);
      ::close(write_end);
      write_end = -1;
      return;
    }
    std::string text = line;
    std::free(line);
    if (!text.empty()) add_history(text.c_str());
    text += '\n';
    [[maybe_unused]] const ssize_t written = ::write(write_end, text.data(), text.size());
  }
};

namespace {

// the library's callbacks carry no context, and a program has one terminal
Prompt::Complete* completing = nullptr;
std::function<void(char*)> entering;
std::vector<std::string> candidates;

void line_entered(char* line) { entering(line); }

char* next_candidate(const char*, int state) {
  static std::size_t next = 0;
  if (state == 0) next = 0;
  return next < candidates.size() ? ::strdup(candidates[next++].c_str()) : nullptr;
}

char** complete_word(const char* word, int start, int) {
  candidates = (*completing)(std::string(rl_line_buffer), static_cast<std::size_t>(start), word);
  if (candidates.empty()) return nullptr;
  rl_attempted_completion_over = 1;
  // after a path its field or its children may follow; nothing follows a verb, a type or a field but a blank
  const std::string before(rl_line_buffer, static_cast<std::size_t>(start));
  const bool path = start > 0 && candidates[0].find('.') == std::string::npos && !before.starts_with("create ") &&
                    !before.starts_with("help ");
  rl_completion_append_character = path ? '\0' : ' ';
  return rl_completion_matches(word, next_candidate);
}

}  // namespace

Prompt::Prompt(channel::Loop& loop, Complete complete) : impl_(std::make_unique<Impl>()) {
  impl_->complete = std::move(complete);
  completing = &impl_->complete;
  entering = [this](char* line) { impl_->entered(line); };
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) == 0) {
    impl_->read_end = ends[0];
    impl_->write_end = ends[1];
  }
  rl_readline_name = const_cast<char*>("dialog_manager");
  rl_attempted_completion_function = complete_word;
  rl_completer_word_break_characters = const_cast<char*>(" \t\"");
  rl_catch_signals = 0;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    impl_->history_file = std::string(home) + "/.dialog_manager_history";
    using_history();
    stifle_history(2000);
    read_history(impl_->history_file.c_str());
  }
  impl_->keys = std::make_unique<channel::ReadyWatch>(loop, STDIN_FILENO, [this] {
    if (impl_->visible) rl_callback_read_char();
    if (impl_->visible) impl_->keys->want();
  });
}

Prompt::~Prompt() {
  if (impl_->visible) hide();
  if (!impl_->history_file.empty()) {
    const mode_t before = ::umask(077);
    write_history(impl_->history_file.c_str());
    ::umask(before);
  }
  if (impl_->write_end >= 0) ::close(impl_->write_end);
}

int Prompt::reader() { return std::exchange(impl_->read_end, -1); }

bool Prompt::visible() const { return impl_->visible; }

void Prompt::show() {
  if (impl_->visible || impl_->write_end < 0) return;
  impl_->visible = true;
  rl_callback_handler_install("> ", line_entered);
  if (!impl_->kept.empty()) {
    rl_insert_text(impl_->kept.c_str());
    rl_redisplay();
    impl_->kept.clear();
  }
  impl_->keys->want();
}

void Prompt::hide() {
  if (!impl_->visible) return;
  impl_->kept = rl_line_buffer == nullptr ? "" : rl_line_buffer;
  rl_callback_handler_remove();
  impl_->visible = false;
  // back to the beginning of the line, and nothing on it
  std::fputs("\r\033[K", stdout);
  std::fflush(stdout);
}

void Prompt::cancel() {
  if (!impl_->visible) return;
  rl_callback_handler_remove();
  impl_->visible = false;
  impl_->kept.clear();
  std::fputs("^C\n", stdout);
  std::fflush(stdout);
}

}  // namespace manager
