#include "manipulators/render/window.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "manipulators/render/shapes.h"

extern char** environ;

namespace render {
namespace {

// an X server without a screen for one test
class Xvfb {
 public:
  Xvfb() {
    int ends[2];
    if (pipe(ends) != 0) return;
    const std::string number = std::to_string(ends[1]);
    const char* words[] = {"Xvfb",       "-displayfd", number.c_str(), "-screen", "0",
                           "800x600x24", "-nolisten",  "tcp",          nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    if (posix_spawnp(&process_, "Xvfb", &actions, nullptr, const_cast<char**>(words), environ) != 0) process_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    // to the end of the line: a server whose pipe is closed before that dies
    std::string text;
    char letter = 0;
    while (process_ > 0 && read(ends[0], &letter, 1) == 1 && letter != '\n') text += letter;
    if (!text.empty()) display_ = ":" + text;
    close(ends[0]);
    if (!display_.empty()) setenv("DISPLAY", display_.c_str(), 1);
  }
  ~Xvfb() { end(); }
  void end() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  bool usable() const { return !display_.empty() && std::system("command -v xdotool >/dev/null 2>&1") == 0; }

 private:
  pid_t process_ = -1;
  std::string display_;
};

// waits for something that another thread brings about, ten seconds at most
template <typename Condition>
bool eventually(Condition condition) {
  for (int k = 0; k < 1000; ++k) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return condition();
}

class Said {
 public:
  void add(const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(line);
  }
  std::vector<std::string> lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

// a ball of 0.2 m in the middle of a picture of 640 x 480, seen from 3 m
Shown ball_in_the_middle() {
  Shown shown;
  shown.scene.lights = three_point_lights();
  Drawable ball;
  ball.geometry = unit_sphere();
  ball.X_WG.scale(0.2f);
  ball.path = "table/ball";
  shown.scene.drawables.push_back(ball);
  shown.camera.X_WC = looking_at({0, 0, 3}, {0, 0, 0});
  shown.camera.field_of_view = 0.7f;
  shown.quality = Quality::draft;
  Handle handle{"table/ball", Eigen::Isometry3d::Identity()};
  handle.X_WP.translation() = Eigen::Vector3d(0, -1, 0);
  shown.handles.push_back(handle);
  return shown;
}

int xdotool(const std::string& words) {
  return std::system(
      ("W=$(xdotool search --sync --onlyvisible --name 'Virtual Sailor' 2>/dev/null | head -1); xdotool " + words +
       " >/dev/null 2>&1")
          .c_str());
}

class SlowWindow : public testing::Test {
 protected:
  void SetUp() override {
    if (!server_.usable()) GTEST_SKIP() << "no Xvfb or xdotool";
    std::string problem;
    window_ = Window::open(
        {640, 480}, [this](const std::string& line) { said_.add(line); }, problem);
    ASSERT_TRUE(window_) << problem;
    window_->show(ball_in_the_middle());
    ASSERT_TRUE(eventually([&] { return window_->pictures() > 0; }));
  }
  Xvfb server_;
  Said said_;
  std::unique_ptr<Window> window_;
};

TEST_F(SlowWindow, DraggingAnObjectSaysWhereItIsInItsParentsFrame) {
  xdotool(
      "mousemove --window $W 320 240 sleep 0.2 mousedown 1 sleep 0.2 mousemove --window $W 330 240 sleep 0.2 "
      "mousemove --window $W 420 240 sleep 0.3 mouseup 1");
  ASSERT_TRUE(eventually([&] { return !said_.lines().empty(); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const std::string last = said_.lines().back();
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(last.c_str(), "set table/ball.position %lf %lf %lf", &x, &y, &z), 3) << last;
  // 100 pixels at the gripped point, 2.8 m away: 2 * 2.8 * tan 0.35 / 480 metres a pixel. It is to the right of the
  // picture, which is +X for a camera that looks along -Z. The parent is 1 m below.
  EXPECT_NEAR(x, 100 * 2 * 2.8 * std::tan(0.35) / 480, 0.004);
  EXPECT_NEAR(y, 1, 0.004);
  EXPECT_NEAR(z, 0, 0.004);
}

TEST_F(SlowWindow, BoundKeysSayTheirCommandsAboutWhatIsUnderThePointer) {
  window_->bind("Key-space", "echo %path");
  xdotool("mousemove --window $W 320 240 sleep 0.2 key --window $W space");
  ASSERT_TRUE(eventually([&] { return !said_.lines().empty(); }));
  EXPECT_EQ(said_.lines()[0], "echo table/ball");
}

TEST_F(SlowWindow, TurningTheCameraDrawsAgainAndSaysNothing) {
  const long long before = window_->pictures();
  xdotool(
      "mousemove --window $W 50 50 sleep 0.2 mousedown 1 sleep 0.2 mousemove --window $W 150 60 sleep 0.3 mouseup 1");
  EXPECT_TRUE(eventually([&] { return window_->pictures() > before; }));
  EXPECT_TRUE(said_.lines().empty());
}

TEST_F(SlowWindow, AVanishedServerIsAStateNotADeath) {
  server_.end();
  EXPECT_TRUE(eventually([&] {
    window_->show(ball_in_the_middle());
    return window_->state() == Window::State::lost;
  }));
}

TEST(Window, WithoutADisplayThereIsAReason) {
  const char* before = std::getenv("DISPLAY");
  const std::string kept = before ? before : "";
  setenv("DISPLAY", ":4242", 1);
  std::string problem;
  EXPECT_FALSE(Window::open(
      {64, 48}, [](const std::string&) {}, problem));
  EXPECT_NE(problem.find(":4242"), std::string::npos);
  EXPECT_FALSE(Window::open(
      {0, 48}, [](const std::string&) {}, problem));
  if (before) setenv("DISPLAY", kept.c_str(), 1);
}

}  // namespace
}  // namespace render
