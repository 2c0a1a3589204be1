// The dialog manager, driven over pipes as any client drives it, beside what the machine allows: the same bytes through
// a bare pipe, a bare barrier of forked workers, a bare write and fdatasync; and beside Redis, when it is installed.
// Every row measures its baseline in the same run, in turns with it. Latencies and ticks have all processes on one
// processor, where a wake-up costs what the kernel needs and nothing of a hypervisor.
//
//   dialog_manager_bench [SECTION...]     latency throughput tick arrays journal restart world memory

#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <span>

#include "tests/bench/dialog_manager_peer.h"

namespace {

using namespace bench;

const std::string manager = BIN_DIR "/dialog_manager";
const std::string me = BIN_DIR "/dialog_manager_bench";
const std::string sheets = BIN_DIR "/../tests/programs/sheets";

double now() {
  timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void require(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "bench: %s\n", what);
  std::exit(1);
}

std::string text(const char* format, double value) {
  std::array<char, 64> out;
  std::snprintf(out.data(), out.size(), format, value);
  return out.data();
}

double quantile(std::vector<double> samples, double q) {
  const auto at = samples.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), at, samples.end());
  return *at;
}

/// A folder of its own, gone at the end.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sailor-bench-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) give_up("mkdtemp");
    path_ = pattern;
  }
  ~Scratch() { std::filesystem::remove_all(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string operator/(std::string_view name) const { return path_ + "/" + std::string(name); }

 private:
  std::string path_;
};

// -- the table

void heading(const char* title) {
  std::printf("%s%-44s %-26s %9s %9s %7s  %-12s\n", title, "quantity", "baseline", "its", "ours", "ratio", "target");
}

void row(const std::string& quantity, const std::string& baseline, const std::string& its, const std::string& ours,
         double ratio, const std::string& target, bool met) {
  std::printf("%-44s %-26s %9s %9s %7.2f  %-12s %s\n", quantity.c_str(), baseline.c_str(), its.c_str(), ours.c_str(),
              ratio, target.c_str(),
              target.empty() ? ""
              : met          ? "met"
                             : "missed");
  std::fflush(stdout);
}

void absent(const std::string& quantity, const std::string& what) {
  std::printf("%-44s %s is not installed\n", quantity.c_str(), what.c_str());
}

/// A ratio to the baseline that must not be above, or not below, a limit.
struct Limit {
  enum class Of { none, ratio_at_most, ratio_at_least, value_at_least } of = Of::none;
  double value = 0;
};

void compare(const std::string& quantity, const std::string& baseline, const char* format, double its, double ours,
             Limit limit) {
  const double ratio = ours / its;
  std::string target;
  bool met = true;
  switch (limit.of) {
    case Limit::Of::none: break;
    case Limit::Of::ratio_at_most:
      target = "<= " + text("%.2f", limit.value) + " x";
      met = ratio <= limit.value;
      break;
    case Limit::Of::ratio_at_least:
      target = ">= " + text("%.2f", limit.value) + " x";
      met = ratio >= limit.value;
      break;
    case Limit::Of::value_at_least:
      target = ">= " + text(format, limit.value);
      met = ours >= limit.value;
      break;
  }
  row(quantity, baseline, text(format, its), text(format, ours), ratio, target, met);
}

constexpr auto at_most = Limit::Of::ratio_at_most, at_least = Limit::Of::ratio_at_least,
               at_least_value = Limit::Of::value_at_least;

// -- peers

/// A forked child that takes what comes and answers as many bytes to each piece.
void echo(std::string_view answer) {
  std::array<char, 65536> bytes;
  while (::read(0, bytes.data(), bytes.size()) > 0)
    if (::write(1, answer.data(), answer.size()) < 0) return;
}

/// Redis on a UNIX socket.
class Redis {
 public:
  static bool installed() { return std::system("command -v redis-server >/dev/null 2>&1") == 0; }

  Redis(const Scratch& folder, const std::vector<std::string>& options)
      : socket_(folder / "redis.sock"), log_(folder / "redis.log") {
    std::vector<std::string> argv = {"redis-server", "--port",    "0",  "--unixsocket", socket_, "--save", "", "--dir",
                                     folder / "",    "--logfile", log_, "--loglevel",   "notice"};
    argv.insert(argv.end(), options.begin(), options.end());
    server_ = std::make_unique<Program>(argv);
    const int descriptor = connect_to(socket_);
    if (descriptor < 0) give_up("redis");
    client_ = std::make_unique<Talk>(descriptor, descriptor);
    // it may still be loading
    while (true) {
      client_->write("PING\r\n");
      if (client_->read_lines(1).starts_with("+PONG")) break;
      ::usleep(1000);
    }
  }
  ~Redis() {
    client_->write("SHUTDOWN NOSAVE\r\n");
    server_->end();
  }
  Talk& client() { return *client_; }

  static std::string command(double x) {
    const std::string value = text("%.2f", x) + " 1.5 -0.25";
    return "*4\r\n$4\r\nHSET\r\n$1\r\na\r\n$1\r\nb\r\n$" + std::to_string(value.size()) + "\r\n" + value + "\r\n";
  }
  /// The numbers as three values of their own.
  static std::string three_values(double x) {
    std::string out = "*8\r\n$4\r\nHSET\r\n$1\r\na\r\n";
    for (const auto& [name, value] : {std::pair("x", text("%.2f", x)), {"y", "1.5"}, {"z", "-0.25"}})
      out.append("$1\r\n").append(name).append("\r\n$" + std::to_string(value.size()) + "\r\n" + value + "\r\n");
    return out;
  }
  /// Seconds that it needed to load its log, as it says itself.
  double loaded_in() const {
    std::ifstream file(log_);
    double seconds = 0;
    for (std::string line; std::getline(file, line);)
      if (const std::size_t at = line.find("append only file: "); at != std::string::npos)
        seconds = std::strtod(line.c_str() + at + 18, nullptr);
    return seconds;
  }

 private:
  std::string socket_, log_;
  std::unique_ptr<Program> server_;
  std::unique_ptr<Talk> client_;
};

constexpr const char* one_thing = "type thing\nfield thing.b vec3 m in -1e9 1e9\ncreate thing a\n";

// a line that changes its field at each turn
std::string set_line(std::size_t turn) {
  return "set a.b " + text("%.2f", static_cast<double>(turn % 1000) / 4) + " 1.5 -0.25\n";
}

std::unique_ptr<Program> framed_manager(const std::vector<std::string>& options = {}) {
  std::vector<std::string> argv = {manager, "--framed"};
  argv.insert(argv.end(), options.begin(), options.end());
  auto out = std::make_unique<Program>(argv);
  out->write(std::string(one_thing) + "@0 sync ready\n");
  out->read_lines(2);
  return out;
}

// -- sections

// seconds of each of `count` round trips
void ping(Talk& peer, const std::vector<std::string>& commands, std::size_t count, std::vector<double>& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const double start = now();
    peer.write(commands[i % commands.size()]);
    peer.read_lines(1);
    out.push_back(now() - start);
  }
}

// round trips a second with so many commands in one piece
double pipelined(Talk& peer, const std::vector<std::string>& pieces, std::size_t each, std::size_t count) {
  const double start = now();
  for (std::size_t i = 0; i < count; ++i) {
    peer.write(pieces[i % pieces.size()]);
    peer.read_lines(each);
  }
  return static_cast<double>(count * each) / (now() - start);
}

void latency() {
  const Pinned pinned;
  const Scratch folder;
  Program pipe([] { echo("@1 ok\n"); });
  const auto ours = framed_manager({"--journal", folder / "a.journal"});
  const Scratch bare_folder, log_folder;
  std::optional<Redis> redis, logging;
  if (Redis::installed()) {
    redis.emplace(bare_folder, std::vector<std::string>{});
    logging.emplace(log_folder, std::vector<std::string>{"--appendonly", "yes"});
  }

  std::vector<std::string> lines, hsets, line_pieces, hset_pieces, triple_pieces;
  constexpr std::size_t in_flight = 64;
  for (std::size_t i = 0; i < 1000; ++i) {
    lines.push_back("@1 " + set_line(i));
    hsets.push_back(Redis::command(static_cast<double>(i) / 4));
  }
  for (std::size_t i = 0; i + in_flight <= lines.size(); i += in_flight) {
    line_pieces.emplace_back();
    hset_pieces.emplace_back();
    triple_pieces.emplace_back();
    for (std::size_t k = i; k < i + in_flight; ++k) {
      line_pieces.back() += lines[k];
      hset_pieces.back() += hsets[k];
      triple_pieces.back() += Redis::three_values(static_cast<double>(k) / 4);
    }
  }

  std::vector<double> pipe_times, our_times, redis_times, logging_times;
  double our_rate = 0, redis_rate = 0, logging_rate = 0, triple_rate = 0, logged_triple_rate = 0;
  for (int round = 0; round < 10; ++round) {
    ping(pipe, lines, 5000, pipe_times);
    ping(*ours, lines, 5000, our_times);
    if (redis) ping(redis->client(), hsets, 5000, redis_times);
    if (logging) ping(logging->client(), hsets, 5000, logging_times);
    our_rate = std::max(our_rate, pipelined(*ours, line_pieces, in_flight, 2000));
    if (redis) redis_rate = std::max(redis_rate, pipelined(redis->client(), hset_pieces, in_flight, 1000));
    if (redis) triple_rate = std::max(triple_rate, pipelined(redis->client(), triple_pieces, in_flight, 1000));
    if (logging) logging_rate = std::max(logging_rate, pipelined(logging->client(), hset_pieces, in_flight, 1000));
    if (logging)
      logged_triple_rate = std::max(logged_triple_rate, pipelined(logging->client(), triple_pieces, in_flight, 1000));
  }
  const auto p = [](const std::vector<double>& samples, double q) { return 1e6 * quantile(samples, q); };
  const std::string trip = "round trip, tag and journal, ", in64 = "64 in flight, tags and journal, M/s";
  compare(trip + "p50 us", "raw pipe", "%.2f", p(pipe_times, 0.5), p(our_times, 0.5), {at_most, 1.5});
  compare(trip + "p99 us", "raw pipe", "%.2f", p(pipe_times, 0.99), p(our_times, 0.99), {at_most, 2});
  if (!redis) {
    absent(trip + "p50 us", "Redis");
    absent(in64, "Redis");
    return;
  }
  compare(trip + "p50 us", "Redis HSET, no log", "%.2f", p(redis_times, 0.5), p(our_times, 0.5), {at_most, 0.45});
  compare(trip + "p50 us", "Redis HSET, log", "%.2f", p(logging_times, 0.5), p(our_times, 0.5), {at_most, 0.45});
  compare(in64, "Redis HSET, no log", "%.2f", 1e-6 * redis_rate, 1e-6 * our_rate, {at_least, 4.5});
  compare(in64, "Redis HSET, log", "%.2f", 1e-6 * logging_rate, 1e-6 * our_rate, {at_least, 4.5});
  // its field is one opaque string above; ours are three numbers, so here they are three values
  compare(in64, "the same, 3 values, no log", "%.2f", 1e-6 * triple_rate, 1e-6 * our_rate, {});
  compare(in64, "the same, 3 values, log", "%.2f", 1e-6 * logged_triple_rate, 1e-6 * our_rate, {});
}

/// Lines a second that a program takes from a pipe; the preamble is not counted, `last` is answered with one line.
double feed(Program& program, const std::string& preamble, const std::string& script, const std::string& last) {
  program.write(preamble + last);
  program.read_lines(1);
  const double start = now();
  program.write(script);
  program.write(last);
  program.read_lines(1);
  const double seconds = now() - start;
  return static_cast<double>(std::count(script.begin(), script.end(), '\n')) / seconds;
}

// counts lines as fast as they come, and answers `sync`
void count_lines() {
  static std::array<char, 65536> bytes;
  std::size_t lines = 0;
  ssize_t count = 0;
  while ((count = ::read(0, bytes.data(), bytes.size())) > 0) {
    lines += static_cast<std::size_t>(std::count(bytes.data(), bytes.data() + count, '\n'));
    const std::string_view got(bytes.data(), static_cast<std::size_t>(count));
    if (got.ends_with("sync end\n") && ::write(1, "end\n", 4) != 4) return;
  }
  ::_exit(lines == 0 ? 1 : 0);
}

void throughput() {
  std::string one, any, preamble = "type thing\n";
  for (std::size_t i = 0; i < 1'000'000; ++i) one += set_line(i);
  constexpr int fields = 10, objects = 10'000;
  for (int i = 0; i < fields; ++i) preamble += "field thing.value_" + std::to_string(i) + " vec3 m in -1e9 1e9\n";
  for (int i = 0; i < objects; ++i) preamble += "create thing object_" + std::to_string(i) + "\n";
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < 1'000'000; ++i)
    any += "set object_" + std::to_string(random() % objects) + ".value_" + std::to_string(random() % fields) + " " +
           text("%.2f", static_cast<double>(random() % 1000) / 4) + " 1.5 -0.25\n";
  double raw = 0, same = 0, spread = 0;
  for (int round = 0; round < 5; ++round) {
    const auto rate = [](Program&& program, const std::string& before, const std::string& script) {
      return 1e-6 * feed(program, before, script, "sync end\n");
    };
    raw = std::max(raw, rate(Program([] { count_lines(); }), "", one));
    same = std::max(same, rate(Program(std::vector{manager}), one_thing, one));
    spread = std::max(spread, rate(Program(std::vector{manager}), preamble, any));
  }
  compare("script lines from a pipe, M/s", "counting newlines", "%.2f", raw, same, {at_least_value, 5});
  compare("  the further target", "the same", "%.2f", raw, same, {at_least_value, 8});
  compare("random sets over 100 000 fields, M/s", "counting newlines", "%.2f", raw, spread, {at_least_value, 4});
  compare("  the further target", "the same", "%.2f", raw, spread, {at_least_value, 6});
}

// -- a manipulator that does next to nothing, made of this very program

/// `idle` answers ticks; `mover` besides moves n0 to n99 at every tick; `reader` hears where nodes are.
int manipulator(std::string_view kind) {
  std::vector<char> bytes(1 << 20);
  std::size_t held = 0;
  std::string out;
  while (true) {
    const ssize_t count = ::read(0, bytes.data() + held, bytes.size() - held);
    if (count <= 0) return 0;
    const char *at = bytes.data(), *end = at + held + count;
    while (const auto* newline = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)))) {
      const std::string_view line(at, static_cast<std::size_t>(newline - at));
      at = newline + 1;
      if (line.starts_with("tick ")) {
        const std::string_view tick = line.substr(5, line.find(' ', 5) - 5);
        if (kind == "mover")
          for (int i = 0; i < 100; ++i)
            out += "set n" + std::to_string(i) + ".position " + std::string(tick) + " 0.5 -0.25\n";
        out.append("done ").append(tick).append("\n");
      } else if (line.starts_with("hello")) {
        if (kind == "mover") out += "writes node.position\n";
        if (kind == "reader") out += "reads node.position\n";
        out += "ready\n";
      } else if (line == "quit") {
        return 0;
      }
    }
    held = static_cast<std::size_t>(end - at);
    std::memmove(bytes.data(), at, held);
    std::string_view rest = out;
    while (!rest.empty()) {
      const ssize_t written = ::write(1, rest.data(), rest.size());
      if (written <= 0) return 1;
      rest.remove_prefix(static_cast<std::size_t>(written));
    }
    out.clear();
  }
}

std::string start_line(const std::string& name, const std::string& kind) {
  return "start " + me + " as " + name + " -- manipulator " + kind + "\n";
}

void tick() {
  const Pinned pinned;
  constexpr std::size_t workers = 5, ticks = 3000;
  std::vector<std::unique_ptr<Program>> hub;
  for (std::size_t i = 0; i < workers; ++i) hub.push_back(std::make_unique<Program>([] { echo("done 12345\n"); }));
  Program ours({manager, "--framed"});
  for (std::size_t i = 0; i < workers; ++i) ours.write(start_line("w" + std::to_string(i), "idle"));
  ours.write("@0 sync ready\n");
  ours.read_until("@0 ok");
  double raw = 1e9, our = 1e9;
  for (int round = 0; round < 10; ++round) {
    double start = now();
    for (std::size_t i = 0; i < ticks; ++i) {
      for (const auto& worker : hub) worker->write("tick 12345 205.75 0.016666666666666666\n");
      for (const auto& worker : hub) worker->read_lines(1);
    }
    raw = std::min(raw, (now() - start) / ticks);
    start = now();
    ours.write("@1 step " + std::to_string(ticks) + "\n");
    ours.read_lines(1);
    our = std::min(our, (now() - start) / ticks);
  }
  compare("lock-step tick, 5 empty manipulators, us", "raw barrier, 5 workers", "%.1f", 1e6 * raw, 1e6 * our,
          {at_most, 1.5});
  compare("  the further target", "the same", "%.1f", 1e6 * raw, 1e6 * our, {at_most, 1.3});
}

// -- long arrays

// what the program `sheets` writes and looks at: every number tells its frame
constexpr std::size_t period = 1024;
const std::array<double, period> fraction = [] {
  std::array<double, period> out;
  for (std::size_t i = 0; i < period; ++i) out[i] = static_cast<double>(i) / period;
  return out;
}();

void write_frame(std::span<double> numbers, double first) {
  for (std::size_t at = 0; at < numbers.size(); at += period) {
    const std::size_t count = std::min(period, numbers.size() - at);
    for (std::size_t i = 0; i < count; ++i) numbers[at + i] = first + fraction[i];
  }
}

bool is_whole(std::span<const double> numbers) {
  std::uint64_t difference = 0;
  for (std::size_t at = 0; at < numbers.size(); at += period) {
    const std::size_t count = std::min(period, numbers.size() - at);
    for (std::size_t i = 0; i < count; ++i)
      difference |=
          std::bit_cast<std::uint64_t>(numbers[at + i]) ^ std::bit_cast<std::uint64_t>(numbers[0] + fraction[i]);
  }
  return difference == 0;
}

/// Three slots that forked processes share.
class Slots {
 public:
  explicit Slots(std::size_t count) : count_(count), size_(3 * count * sizeof(double)) {
    const int file = ::memfd_create("bare", MFD_CLOEXEC);
    if (file < 0 || ::posix_fallocate(file, 0, static_cast<off_t>(size_)) != 0) give_up("memfd");
    void* at = ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file, 0);
    if (at == MAP_FAILED) give_up("mmap");
    ::close(file);
    numbers_ = static_cast<double*>(at);
  }
  ~Slots() { ::munmap(numbers_, size_); }
  Slots(const Slots&) = delete;
  Slots& operator=(const Slots&) = delete;
  std::span<double> operator[](std::size_t frame) const { return {numbers_ + frame % 3 * count_, count_}; }

 private:
  std::size_t count_, size_;
  double* numbers_;
};

// the frame that a line of theirs tells of
std::size_t frame_said(std::string_view line) {
  std::size_t frame = 0;
  std::from_chars(line.data(), line.data() + line.size(), frame);
  return frame;
}

// a child that answers each line after it has done what is to be done with its frame
std::unique_ptr<Program> answering(const std::function<bool(std::size_t frame)>& work) {
  return std::make_unique<Program>([&work] {
    std::array<char, 64> line;
    for (ssize_t count = 0; (count = ::read(0, line.data(), line.size())) > 0;)
      if (!work(frame_said({line.data(), static_cast<std::size_t>(count)})) || ::write(1, "ok\n", 3) != 3) ::_exit(1);
  });
}

void exchange(Talk& peer, std::size_t frame) {
  peer.write(std::to_string(frame) + "\n");
  peer.read_lines(1);
}

// seconds from frame to frame: written, told of, read, acknowledged
std::vector<double> bare_frames(std::size_t numbers, std::size_t frames) {
  const Slots slots(numbers);
  const auto reader = answering([&](std::size_t frame) { return is_whole(slots[frame]); });
  std::vector<double> times;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const double start = now();
    write_frame(slots[frame], static_cast<double>(4 * frame));
    exchange(*reader, frame);
    times.push_back(now() - start);
  }
  return times;
}

// likewise, through a third process that makes a copy of its own before it tells the reader
std::vector<double> relayed_frames(std::size_t numbers, std::size_t frames) {
  const Slots filled(numbers), kept(numbers);
  const auto relay = answering([&](std::size_t frame) {
    static const auto reader = answering([&](std::size_t copied) { return is_whole(kept[copied]); });
    std::memcpy(kept[frame].data(), filled[frame].data(), filled[frame].size_bytes());
    exchange(*reader, frame);
    return true;
  });
  std::vector<double> times;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const double start = now();
    write_frame(filled[frame], static_cast<double>(4 * frame));
    exchange(*relay, frame);
    times.push_back(now() - start);
  }
  return times;
}

// likewise, as the shortest text, through a pipe
std::vector<double> text_frames(std::size_t numbers, std::size_t frames) {
  Program reader([numbers] {
    std::vector<double> read(numbers);
    std::string text(32 * numbers, ' ');
    std::size_t held = 0;
    for (ssize_t count = 0; (count = ::read(0, text.data() + held, text.size() - held)) > 0;) {
      held += static_cast<std::size_t>(count);
      if (text[held - 1] != '\n') continue;
      const char *at = text.data(), *end = at + held;
      for (double& each : read) at = std::from_chars(at, end, each).ptr + 1;
      held = 0;
      if (!is_whole(read) || ::write(1, "ok\n", 3) != 3) ::_exit(1);
    }
  });
  std::vector<double> values(numbers), times;
  std::string text(32 * numbers, ' ');
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const double start = now();
    write_frame(values, static_cast<double>(4 * frame));
    char* at = text.data();
    for (const double each : values) {
      at = std::to_chars(at, at + 30, each).ptr;
      *at++ = ' ';
    }
    at[-1] = '\n';
    reader.write({text.data(), static_cast<std::size_t>(at - text.data())});
    reader.read_lines(1);
    times.push_back(now() - start);
  }
  return times;
}

// from the program that fills to the one that reads: the seconds between ticks of the first
std::vector<double> our_frames(std::size_t points, std::size_t frames, bool text) {
  const Scratch folder;
  const std::string file = folder / "times", with = text ? " with env SAILOR_ARRAYS=text" : "";
  // the first are text, or take memory
  constexpr std::size_t warm = 100;
  {
    Program session({manager, "--framed"});
    session.write("start " + sheets + " as fill" + with + " -- fill " + file + "\nstart " + sheets + " as read" + with +
                  " -- read\ncreate sheet s count " + std::to_string(points) + "\ncreate reader r\nstep " +
                  std::to_string(warm + frames) +
                  "\n@1 expect r.torn == 0\n@2 expect r.frames == " + std::to_string(warm + frames) + "\n@3 quit\n");
    session.read_until("@1 ok");
    session.read_until("@2 ok");
    session.read_until("@3 ok");
    require(session.end() == 0, "the manager did not end well");
  }
  std::vector<double> times(warm + frames);
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(times.data()), static_cast<std::streamsize>(times.size() * sizeof(double)));
  require(in.gcount() == static_cast<std::streamsize>(times.size() * sizeof(double)), "no times of frames");
  times.erase(times.begin(), times.begin() + warm);
  return times;
}

void arrays_of(std::size_t points, const std::string& where, bool text) {
  const std::size_t numbers = 3 * points, frames = points < 1000 ? 20'000 : 2000, text_count = frames / 20;
  std::vector<double> bare, relayed, ours, bare_text, our_text;
  const auto add = [](std::vector<double>& to, const std::vector<double>& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  for (int round = 0; round < 3; ++round) {
    add(bare, bare_frames(numbers, frames));
    add(relayed, relayed_frames(numbers, frames));
    add(ours, our_frames(points, frames, false));
    if (!text) continue;
    add(bare_text, text_frames(numbers, text_count));
    add(our_text, our_frames(points, text_count, true));
  }
  const std::string what =
      (points < 1000 ? std::to_string(points) : std::to_string(points / 1000) + " 000") + " points";
  for (const auto& [name, q] : {std::pair{", p50 us", 0.5}, {", p99 us", 0.99}}) {
    const auto us = [&, share = q](const std::vector<double>& times) { return 1e6 * quantile(times, share); };
    compare(what + where + name, "memfd, a line, an answer", "%.1f", us(bare), us(ours), {});
    compare(what + where + name, "  with a copy between", "%.1f", us(relayed), us(ours), {at_most, 1.3});
    if (text)
      compare(what + " as text" + where + name, "shortest text, a pipe", "%.0f", us(bare_text), us(our_text), {});
  }
}

void arrays() {
  {
    const Pinned pinned;
    arrays_of(400, "", true);
    arrays_of(50'000, "", true);
  }
  arrays_of(50'000, ", any processor", false);
}

// -- memory of what was said

// seconds of each write and fdatasync of so many bytes, each behind the one before
void sync_loop(int file, off_t& end, std::size_t count, std::string_view bytes, std::vector<double>& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const double start = now();
    if (::pwrite(file, bytes.data(), bytes.size(), end) < 0 || ::fdatasync(file) != 0) give_up("fdatasync");
    end += static_cast<off_t>(bytes.size());
    out.push_back(now() - start);
  }
}

void synced() {
  const Scratch folder;
  // a file that grows with every write has a new length to sync too; one that has its room has not, as a journal
  const int growing = ::open((folder / "growing").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const int roomy = ::open((folder / "roomy").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (growing < 0 || roomy < 0 || ::posix_fallocate(roomy, 0, 1 << 20) != 0) give_up("open");
  off_t growing_end = 0, roomy_end = 0;
  const auto ours = framed_manager();
  ours->write("@0 journal " + (folder / "a.journal") + " always\n");
  ours->read_lines(1);
  std::optional<Redis> redis;
  if (Redis::installed())
    redis.emplace(folder, std::vector<std::string>{"--appendonly", "yes", "--appendfsync", "always"});
  std::vector<std::string> lines, hsets;
  for (std::size_t i = 0; i < 1000; ++i) {
    lines.push_back("@1 " + set_line(i));
    hsets.push_back(Redis::command(static_cast<double>(i) / 4));
  }
  std::vector<double> growing_times, roomy_times, our_times, redis_times;
  for (int round = 0; round < 10; ++round) {
    sync_loop(growing, growing_end, 200, std::string(50, 'x') + "\n", growing_times);
    sync_loop(roomy, roomy_end, 200, std::string(50, 'x') + "\n", roomy_times);
    ping(*ours, lines, 200, our_times);
    if (redis) ping(redis->client(), hsets, 200, redis_times);
  }
  ::close(growing);
  ::close(roomy);
  const auto rate = [](const std::vector<double>& times) { return 1e-3 / quantile(times, 0.5); };
  compare("fsync always, one client, k/s", "fdatasync, room reserved", "%.2f", rate(roomy_times), rate(our_times),
          {at_least, 0.9});
  compare("fsync always, one client, k/s", "fdatasync, file grows", "%.2f", rate(growing_times), rate(our_times), {});
  if (redis)
    compare("fsync always, one client, k/s", "Redis, log always", "%.2f", rate(redis_times), rate(our_times), {});
  else
    absent("fsync always, one client, k/s", "Redis");
}

void replayed() {
  constexpr std::size_t lines = 1'000'000, lines_a_tick = 1000;
  const Scratch folder;
  const std::string journal = folder / "long.journal";
  {
    Program writer({manager, "--journal", journal});
    std::string script = one_thing;
    for (std::size_t i = 0; i < lines; ++i) {
      script += set_line(i);
      if (i % lines_a_tick == 0) script += "step\n";
    }
    writer.write(script);
    require(writer.end() == 0, "the journal could not be made");
  }
  double our = 0, loaded = 0;
  for (int round = 0; round < 5; ++round) {
    const double start = now();
    Program reader(std::vector<std::string>{manager, "-c", "replay " + journal});
    require(reader.end() == 0, "the journal could not be replayed");
    our = std::max(our, static_cast<double>(lines) / (now() - start));
  }
  if (Redis::installed()) {
    const std::vector<std::string> log = {"--appendonly", "yes"};
    {
      Redis writer(folder, log);
      std::string piece;
      for (std::size_t i = 0; i < 1000; ++i) piece += Redis::command(static_cast<double>(i) / 4);
      for (std::size_t i = 0; i < lines / 1000; ++i) {
        writer.client().write(piece);
        writer.client().read_lines(1000);
      }
    }
    loaded = static_cast<double>(lines) / Redis(folder, log).loaded_in();
  }
  const std::string quantity = "replay of a journal, hash at every tick, M/s";
  if (loaded > 0)
    compare(quantity, "Redis loading its log", "%.2f", 1e-6 * loaded, 1e-6 * our, {at_least_value, 4});
  else
    row(quantity, "Redis is not installed", "", text("%.2f", 1e-6 * our), 0, ">= 4.00", our >= 4e6);
}

void journal() {
  synced();
  replayed();
}

// -- a manipulator is killed

void restart() {
  constexpr int lives = 4;  // of one manipulator, which may start five times in ten seconds
  std::vector<double> floor, ours;
  Program session({manager, "--framed"});
  for (int one = 0; one < 6; ++one) {
    for (int life = 0; life < lives; ++life) {
      Program victim({me, "manipulator", "idle"});
      victim.write("hello\n");
      victim.read_lines(1);
      const double start = now();
      victim.kill();
      char byte = 0;
      require(::read(victim.in(), &byte, 1) == 0, "no end");
      Program next({me, "manipulator", "idle"});
      next.write("hello\ntick 1 0 0\n");
      next.read_lines(2);
      floor.push_back(now() - start);
    }
    session.write("@0 " + start_line("w" + std::to_string(one), "idle") + "@1 step 10\n");
    session.read_until("@1 ok");
    for (int life = 0; life < lives; ++life) {
      const pid_t victim = session.children().front();
      const double start = now();
      ::kill(victim, SIGKILL);
      session.write("@1 step\n");
      session.read_until("@1 ok");
      ours.push_back(now() - start);
      require(session.children().front() != victim, "the manipulator lives");
    }
    session.write("@2 end w" + std::to_string(one) + "\n");
    session.read_until("@2 ok");
  }
  compare("kill -9 of a manipulator to the next tick, ms", "kill, spawn, first reply", "%.2f",
          1e3 * quantile(floor, 0.5), 1e3 * quantile(ours, 0.5), {at_most, 2});
}

// -- worlds of any size

void world() {
  std::printf(
      "\nA tick with 100 changes in a world of N nodes: written by one program, read by another, kept in a "
      "journal, hashed;\nprocessor time of the manager\n");
  std::printf("%9s %12s %16s %16s %16s\n", "nodes", "us a tick", "to 100 nodes", "bytes a node", "bytes a thing");
  double first = 0;
  for (const int nodes : {100, 1'000, 10'000, 100'000, 1'000'000}) {
    const Scratch folder;
    Program session({manager, "--framed", "--journal", folder / "a.journal"});
    const auto wait = [&](const std::string& lines) {
      session.write(lines + "@0 sync ready\n");
      session.read_until("@0 ok");
    };
    const auto fill = [&](const std::string& type, const std::string& letter) {
      const double before = session.memory("VmRSS");
      std::string lines;
      for (int i = 0; i < nodes; ++i) lines += "create " + type + " " + letter + std::to_string(i) + "\n";
      wait(lines);
      return (session.memory("VmRSS") - before) / nodes;
    };
    wait(one_thing);
    const double node = fill("node", "n"), thing = fill("thing", "t");
    wait(start_line("mover", "mover") + start_line("reader", "reader"));
    session.write("@1 step 20\n");
    session.read_until("@1 ok");
    double best = 1e9;
    for (int round = 0; round < 10; ++round) {
      const double start = session.cpu_seconds();
      session.write("@1 step 50\n");
      session.read_until("@1 ok");
      best = std::min(best, (session.cpu_seconds() - start) / 50);
    }
    if (first == 0) first = best;
    std::printf("%9d %12.1f %16.2f %16.0f %16.0f\n", nodes, 1e6 * best, best / first, node, thing);
    std::fflush(stdout);
  }
}

// -- memory stays flat

void memory() {
  constexpr double megabyte = 1 << 20;
  std::printf("\nMemory that must stay flat, MB\n");
  const auto line = [](const char* what, double before, double most) {
    std::printf("%-60s %8.1f %s\n", what, (most - before) / megabyte, most - before < 16 * megabyte ? "flat" : "GROWS");
  };
  {
    Program session({manager, "--framed", "--keep-going"});
    session.write("@0 sync ready\n");
    session.read_lines(2);
    const double before = session.memory("VmHWM");
    const std::string piece(1 << 20, 'x');
    for (int i = 0; i < 100; ++i) session.write(piece);
    session.write("\n@1 sync again\n");
    session.read_until("@1 ok");
    line("a line of 100 MB", before, session.memory("VmHWM"));
  }
  {
    const auto session = framed_manager();
    std::string script;
    for (std::size_t i = 0; i < 1'000'000; ++i) script += set_line(i);
    const auto say = [&] {
      session->write(script + "@1 sync again\n");
      session->read_lines(2);
    };
    say();
    const double before = session->memory("VmHWM");
    for (int i = 0; i < 5; ++i) say();
    line("five more million lines without a tick", before, session->memory("VmHWM"));
  }
  {
    const auto session = framed_manager();
    const double before = session->memory("VmHWM");
    ::fcntl(session->out(), F_SETFL, O_NONBLOCK);
    // until it has not taken a byte for half a second
    const std::string piece = "@1 get a\n";
    for (double last = now(); now() - last < 0.5;) {
      if (::write(session->out(), piece.data(), piece.size()) > 0)
        last = now();
      else
        ::usleep(1000);
    }
    line("a client that asks and never reads the answers", before, session->memory("VmHWM"));
    session->kill();
  }
}

struct Section {
  std::string_view name;
  void (*run)();
};
constexpr Section sections[] = {{"latency", latency}, {"throughput", throughput}, {"tick", tick},   {"arrays", arrays},
                                {"journal", journal}, {"restart", restart},       {"world", world}, {"memory", memory}};

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> wanted(argv + 1, argv + argc);
  if (wanted.size() == 2 && wanted[0] == "manipulator") return manipulator(wanted[1]);
  ::signal(SIGPIPE, SIG_IGN);
  heading("");
  for (const Section& section : sections)
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), section.name) != wanted.end()) section.run();
}
