#include "manipulators/render/speaker.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include "manipulators/render/no_sigpipe.h"

namespace render {

Speaker::Speaker() {
  const char* base = std::getenv("TMPDIR");
  std::string folder = std::string(base && *base ? base : "/tmp") + "/sailor_XXXXXX";
  if (!mkdtemp(folder.data())) return;
  folder_ = folder;
  const std::string path = folder + "/window";
  if (mkfifo(path.c_str(), 0600) == 0) path_ = path;
}

Speaker::~Speaker() {
  if (pipe_ >= 0) close(pipe_);
  if (!path_.empty()) unlink(path_.c_str());
  if (!folder_.empty()) rmdir(folder_.c_str());
}

bool Speaker::say(const std::string& line) {
  if (path_.empty() || line.size() + 1 > PIPE_BUF) return false;
  if (pipe_ < 0) pipe_ = open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  if (pipe_ < 0) return false;
  NoSigpipe guard;
  const std::string whole = line + "\n";
  // up to PIPE_BUF bytes go whole or not at all
  if (write(pipe_, whole.data(), whole.size()) == static_cast<ssize_t>(whole.size())) return true;
  close(pipe_);
  pipe_ = -1;
  return false;
}

}  // namespace render
