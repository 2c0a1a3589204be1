#include "manipulators/render/movie.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "manipulators/render/no_sigpipe.h"

extern char** environ;

namespace render {

namespace {

std::vector<std::string> encoder_command(const std::string& path, Size size, double rate) {
  char rate_text[32];
  std::snprintf(rate_text, sizeof rate_text, "%.9g", rate);
  std::vector<std::string> words = {
      "ffmpeg",     "-hide_banner", "-loglevel",
      "error",      "-nostdin",     "-y",
      "-f",         "rawvideo",     "-pixel_format",
      "rgba",       "-video_size",  std::to_string(size.width) + "x" + std::to_string(size.height),
      "-framerate", rate_text,      "-i",
      "pipe:0",     "-threads",     "1"};
  if (path.ends_with(".mp4")) {
    words.insert(words.end(), {"-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p",
                               "-movflags", "+faststart"});
  }
  // file: so that no name is taken for an option or an address
  words.insert(words.end(), {"-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact", "file:" + path});
  return words;
}

std::string frame_name(const std::string& folder, int frame) {
  char name[40];
  std::snprintf(name, sizeof name, "/frame_%06d.png", frame);
  return folder + name;
}

}  // namespace

std::unique_ptr<Movie> Movie::start(const std::string& path, Size size, double rate, double time,
                                    std::string& problem) {
  problem = size_problem(size);
  if (!problem.empty()) return nullptr;
  std::unique_ptr<Movie> movie(new Movie);
  movie->path_ = path;
  movie->size_ = size;
  movie->rate_ = rate;
  movie->start_ = time;
  const std::string ending = std::filesystem::path(path).extension();
  movie->is_folder_ = ending.empty();
  if (movie->is_folder_) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) problem = "cannot make the folder '" + path + "': " + error.message();
    return problem.empty() ? std::move(movie) : nullptr;
  }
  if (ending != ".mp4" && ending != ".webm" && ending != ".gif") {
    problem = "a film is .mp4, .webm, .gif or a folder, not '" + path + "'";
    return nullptr;
  }
  if (size.width % 2 != 0 || size.height % 2 != 0) {
    problem = "a film needs even sides, not " + std::to_string(size.width) + "x" + std::to_string(size.height);
    return nullptr;
  }

  int frames[2], complaints[2];
  if (pipe2(frames, O_CLOEXEC) != 0) {
    problem = std::string("no pipe: ") + std::strerror(errno);
    return nullptr;
  }
  if (pipe2(complaints, O_CLOEXEC) != 0) {
    problem = std::string("no pipe: ") + std::strerror(errno);
    close(frames[0]);
    close(frames[1]);
    return nullptr;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, frames[0], 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, complaints[1], 2);
  std::vector<std::string> words = encoder_command(path, size, rate);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(frames[0]);
  close(complaints[1]);
  movie->pipe_ = frames[1];
  movie->complaints_ = complaints[0];
  if (failed != 0) {
    problem = std::string("cannot start ffmpeg: ") + std::strerror(failed);
    return nullptr;
  }
  movie->process_ = process;
  return movie;
}

Movie::~Movie() { finish(); }

int Movie::due(double time) const {
  // a frame time that falls on a tick must not be missed by rounding
  const double passed = (time - start_) * rate_;
  return passed < 0 ? 0 : static_cast<int>(std::floor(passed + 1e-6)) - frames_;
}

std::string Movie::add(const Picture& picture) {
  if (picture.size() != size_) return "the picture has another size than the film";
  if (is_folder_) {
    std::string problem = write_png(picture, frame_name(path_, frames_));
    if (problem.empty()) ++frames_;
    return problem;
  }
  NoSigpipe guard;
  const std::uint8_t* data = picture.data();
  std::size_t left = picture.byte_count();
  while (left > 0) {
    const ssize_t count = write(pipe_, data, left);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const std::string complaint = finish();
      return complaint.empty() ? "the encoder has ended" : complaint;
    }
    data += count;
    left -= static_cast<std::size_t>(count);
  }
  ++frames_;
  return {};
}

std::string Movie::finish() {
  if (pipe_ >= 0) close(pipe_);
  pipe_ = -1;
  std::string complaint;
  if (complaints_ >= 0 && process_ > 0) {
    char text[512];
    ssize_t count;
    while ((count = read(complaints_, text, sizeof text)) > 0 || (count < 0 && errno == EINTR)) {
      if (count > 0 && complaint.size() < 2000) complaint.append(text, static_cast<std::size_t>(count));
    }
  }
  if (complaints_ >= 0) close(complaints_);
  complaints_ = -1;
  if (process_ > 0) {
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
    process_ = -1;
    if (WIFSIGNALED(status))
      return "ffmpeg was ended by signal " + std::to_string(WTERMSIG(status)) + " at '" + path_ + "'";
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      for (char& c : complaint) c = c == '\n' ? ' ' : c;
      return "ffmpeg failed on '" + path_ + "': " + complaint;
    }
  }
  return {};
}

}  // namespace render
