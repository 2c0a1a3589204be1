#include "dialog_manager/channel/child.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace channel {
namespace {

// the next whole line, or what else there is
LineBuffer::Next next_of(Reader& reader, std::string_view& line) {
  using Next = LineBuffer::Next;
  while (true) {
    const Next next = reader.lines().next(line);
    if (next != Next::none) return next;
    reader.want();
    if (!reader.lines().has_line() && !reader.at_end()) return next;
  }
}

}  // namespace

objdb::Result<std::unique_ptr<Child>> Child::start(Loop& loop, const std::vector<std::string>& argv,
                                                   std::size_t longest_line) {
  const objdb::Result<Process> process = spawn(argv);
  if (!process) return process.error();
  return std::unique_ptr<Child>(new Child(loop, *process, longest_line));
}

Child::Child(Loop& loop, Process process, std::size_t longest_line)
    : process_(process),
      output_(loop, process.output, Descriptor::own, longest_line),
      errors_(loop, process.errors, Descriptor::own, longest_line),
      input_(std::make_unique<Writer>(loop, process.input, Descriptor::own)),
      exit_(loop, process.pidfd, [this] { exited_ = true; }) {}

Child::~Child() {
  if (process_.pid <= 0) return;
  ::kill(-process_.pid, SIGKILL);
  ::waitpid(process_.pid, nullptr, 0);
}

Child::Next Child::next(std::string_view& line) {
  while (true) {
    switch (next_of(output_, line)) {
      case LineBuffer::Next::line: return Next::line;
      case LineBuffer::Next::too_long: return Next::too_long;
      case LineBuffer::Next::half: break;
      case LineBuffer::Next::end: return Next::end;
      // who has ended and left its output to a child of its own says no more
      case LineBuffer::Next::none: return exited_ ? Next::end : Next::none;
    }
  }
}

Child::Next Child::next_complaint(std::string_view& line) {
  switch (next_of(errors_, line)) {
    case LineBuffer::Next::line:
    case LineBuffer::Next::half: return Next::line;
    case LineBuffer::Next::too_long: return Next::too_long;
    case LineBuffer::Next::end: return Next::end;
    case LineBuffer::Next::none: break;
  }
  return Next::none;
}

std::string Child::end() {
  std::string how = reap(process_.pid);
  // a moment to end by itself, so that its exit status can be told
  for (int i = 0; i < 20 && how.empty() && !exited_; ++i) {
    ::usleep(1000);
    how = reap(process_.pid);
  }
  ::kill(-process_.pid, SIGKILL);
  if (how.empty()) {
    ::waitpid(process_.pid, nullptr, 0);
    how = "closed output";
  }
  process_.pid = -1;
  return how;
}

}  // namespace channel
