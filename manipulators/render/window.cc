#include "manipulators/render/window.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include "manipulators/render/navigator.h"
#include "manipulators/render/no_sigpipe.h"
#include "manipulators/render/pick.h"
#include "manipulators/render/screen.h"
#include "objdb/text.h"

namespace render {

namespace {

constexpr float click_slack = 3;          // pixels that a click may move
constexpr float turn_per_pixel = 0.006f;  // [rad]
constexpr float usual_distance = 2.5f;    // to turn about when nothing is in the middle [m]

}  // namespace

class Window::Server {
 public:
  Server(Size size, std::function<void(const std::string&)> say) : size_(size), say_(std::move(say)) {}

  ~Server() {
    stop_ = true;
    wake();
    if (thread_.joinable()) thread_.join();
    for (int end : wake_) {
      if (end >= 0) close(end);
    }
  }

  // starts the thread and waits until the window is there or cannot be
  std::string start() {
    if (pipe2(wake_, O_CLOEXEC | O_NONBLOCK) != 0) return "no pipe to wake the window";
    std::promise<std::string> ready;
    auto answer = ready.get_future();
    thread_ = std::thread([this, &ready] { serve(ready); });
    return answer.get();
  }

  void show(Shown shown) {
    {
      const std::lock_guard lock(mutex_);
      next_ = std::make_shared<const Shown>(std::move(shown));
    }
    wake();
  }

  void bind(const std::string& event, const std::string& command) {
    const std::lock_guard lock(mutex_);
    bindings_.bind(event, command);
  }

  bool unbind(const std::string& event) {
    const std::lock_guard lock(mutex_);
    return bindings_.unbind(event);
  }

  State state() const { return state_; }
  long long pictures() const { return pictures_; }

 private:
  // the drag that is going on
  struct Drag {
    int button = 0;
    float start_x = 0, start_y = 0;
    float last_x = 0, last_y = 0;
    bool moved = false;
    bool shift = false;
    const Handle* handle = nullptr;     // the object being dragged, if any
    std::string path;                   // under the pointer when it began
    Eigen::Vector3f grip{0, 0, 0};      // the point that was gripped
    Eigen::Vector3f origin{0, 0, 0};    // of the object when it began [m, world]
    std::shared_ptr<const Shown> held;  // keeps `handle` alive
  };

  void wake() {
    const char byte = 0;
    // a full pipe wakes as well
    if (write(wake_[1], &byte, 1) < 0) return;
  }

  void serve(std::promise<std::string>& ready) {
    // Xlib writes to its server without asking whether it still lives
    const NoSigpipe guard;
    std::string problem;
    auto canvas = Canvas::make(problem);
    auto screen = canvas ? Screen::open(size_, "The Virtual Sailor", problem) : nullptr;
    // after this call `ready` is gone
    const bool good = screen != nullptr;
    ready.set_value(problem);
    if (!good) return;
    bool stale = true;
    while (!stop_ && screen->alive() && state_ == State::open) {
      for (const ScreenEvent& event : screen->events(wake_[0], stale ? 0 : -1)) stale |= handle(event);
      stale |= take_next();
      if (!stale || !shown_ || state_ != State::open) continue;
      if (canvas->draw(scene_to_draw(), camera(), size_, shown_->quality, picture_).empty()) {
        screen->put(picture_);
        ++pictures_;
      }
      stale = false;
    }
    if (!screen->alive()) state_ = State::lost;
  }

  // takes over what show() left; true when there is something new
  bool take_next() {
    const std::lock_guard lock(mutex_);
    if (!next_) return false;
    shown_ = std::move(next_);
    next_.reset();
    moved_path_.clear();
    return true;
  }

  Camera camera() const { return free_ ? navigator_.camera() : shown_->camera; }

  // what is shown, with the object that is being dragged where the pointer is and the selection's path
  Scene scene_to_draw() const {
    Scene scene = shown_->scene;
    if (!moved_path_.empty()) {
      for (Drawable& drawable : scene.drawables) {
        if (drawable.path == moved_path_) drawable.X_WG.pretranslate(moved_by_);
      }
    }
    if (!selected_.empty()) scene.labels.push_back({selected_, 16, -16, 20, {255, 226, 140, 255}});
    return scene;
  }

  std::optional<Hit> hit_at(float x, float y) const {
    return shown_ ? pick(shown_->scene, ray_through(camera(), size_, x, y)) : std::nullopt;
  }

  Gesture gesture_at(const ScreenEvent& event, const std::string& name) const {
    Gesture gesture;
    gesture.event = event.modifiers + name;
    if (const auto hit = hit_at(event.x, event.y)) {
      gesture.path = shown_->scene.drawables[hit->drawable].path;
      gesture.point = hit->point.cast<double>();
      gesture.has_point = true;
    }
    return gesture;
  }

  // says what is bound to the gesture; false when nothing is
  bool say_bound(const Gesture& gesture) {
    std::string line;
    {
      const std::lock_guard lock(mutex_);
      if (!bindings_.bound(gesture.event)) return false;
      line = bindings_.command(gesture);
    }
    if (!line.empty()) say_(line);
    return true;
  }

  void free_the_camera() {
    if (free_ || !shown_) return;
    const auto ahead = hit_at(static_cast<float>(size_.width) / 2, static_cast<float>(size_.height) / 2);
    const Eigen::Vector3f eye = shown_->camera.X_WC.translation();
    navigator_.start(shown_->camera, ahead ? (ahead->point - eye).norm() : usual_distance);
    free_ = true;
  }

  // true when the picture is no longer right
  bool handle(const ScreenEvent& event) {
    using Kind = ScreenEvent::Kind;
    switch (event.kind) {
      case Kind::close: state_ = State::closed; return false;
      case Kind::expose: return true;
      case Kind::resize:
        if (!size_problem(event.size).empty() || event.size == size_) return false;
        size_ = event.size;
        return true;
      case Kind::key:
        if (shown_ && say_bound(gesture_at(event, "Key-" + event.name))) return false;
        if (event.name != "Home") return false;
        free_ = false;
        return true;
      case Kind::press: return shown_ && press(event);
      case Kind::motion: return shown_ && drag(event);
      case Kind::release: return shown_ && release(event);
    }
    return false;
  }

  bool press(const ScreenEvent& event) {
    if (event.name.starts_with("Wheel")) {
      if (say_bound(gesture_at(event, event.name))) return false;
      free_the_camera();
      navigator_.zoom(event.name == "Wheel-up" ? 0.9f : 1 / 0.9f);
      return true;
    }
    drag_ = Drag();
    drag_.button = event.name.back() - '0';
    drag_.start_x = drag_.last_x = event.x;
    drag_.start_y = drag_.last_y = event.y;
    drag_.shift = event.modifiers.find("Shift-") != std::string::npos;
    if (const auto hit = hit_at(event.x, event.y)) {
      drag_.path = shown_->scene.drawables[hit->drawable].path;
      drag_.grip = hit->point;
      drag_.origin = shown_->scene.drawables[hit->drawable].X_WG.translation();
      for (const Handle& handle : shown_->handles) {
        if (handle.path == drag_.path) drag_.handle = &handle;
      }
      drag_.held = shown_;
    }
    return false;
  }

  bool drag(const ScreenEvent& event) {
    if (drag_.button == 0 || !event.button[drag_.button]) return false;
    const float right = event.x - drag_.last_x;
    const float down = event.y - drag_.last_y;
    if (!drag_.moved && std::hypot(event.x - drag_.start_x, event.y - drag_.start_y) <= click_slack) return false;
    drag_.moved = true;
    drag_.last_x = event.x;
    drag_.last_y = event.y;

    // where the gripped point has come to, in the plane through it that faces the camera
    const std::string name = "Button" + std::to_string(drag_.button) + "-drag";
    const auto point = drag_.path.empty()
                           ? std::nullopt
                           : on_view_plane(camera(), ray_through(camera(), size_, event.x, event.y), drag_.grip);
    Gesture gesture;
    gesture.event = event.modifiers + name;
    gesture.path = drag_.path;
    gesture.has_point = point.has_value();
    if (point) gesture.point = (drag_.origin + (*point - drag_.grip)).cast<double>();
    if (say_bound(gesture)) return false;

    if (drag_.button == 1 && drag_.handle && !drag_.shift) {
      if (!point) return false;
      move_object(gesture.point.cast<float>());
      return true;
    }
    free_the_camera();
    if (drag_.button == 1 && !drag_.shift) {
      navigator_.orbit(-right * turn_per_pixel, down * turn_per_pixel);
    } else if (drag_.button == 3) {
      navigator_.zoom(std::exp(down * 0.008f));
    } else {
      navigator_.pan(right, down, size_);
    }
    return true;
  }

  // shows the object there at once, and says so
  void move_object(const Eigen::Vector3f& where) {
    moved_path_ = drag_.path;
    for (const Drawable& drawable : shown_->scene.drawables) {
      if (drawable.path == drag_.path) moved_by_ = where - drawable.X_WG.translation();
    }
    const Eigen::Vector3d p_P = drag_.handle->X_WP.inverse() * where.cast<double>();
    std::string line = "set " + drag_.path + ".position";
    for (int axis = 0; axis < 3; ++axis) {
      line += ' ';
      // a tenth of a millimetre is less than any pixel
      objdb::append_number(line, std::round(p_P[axis] * 1e4) / 1e4);
    }
    say_(line);
  }

  bool release(const ScreenEvent& event) {
    const Drag ended = std::move(drag_);
    drag_ = Drag();
    if (ended.button == 0 || event.name != "Button" + std::to_string(ended.button) || ended.moved) return false;
    // a click
    if (say_bound(gesture_at(event, event.name))) return false;
    if (ended.button != 1) return false;
    selected_ = ended.path;
    return true;
  }

  Size size_;
  std::function<void(const std::string&)> say_;
  std::thread thread_;
  int wake_[2] = {-1, -1};
  std::atomic<bool> stop_{false};
  std::atomic<State> state_{State::open};
  std::atomic<long long> pictures_{0};

  std::mutex mutex_;  // guards the next two
  std::shared_ptr<const Shown> next_;
  Bindings bindings_;

  // only the thread's own from here on
  std::shared_ptr<const Shown> shown_;
  Navigator navigator_;
  bool free_ = false;
  Drag drag_;
  std::string selected_, moved_path_;
  Eigen::Vector3f moved_by_{0, 0, 0};
  Picture picture_;
};

std::unique_ptr<Window> Window::open(Size size, std::function<void(const std::string&)> say, std::string& problem) {
  problem = size_problem(size);
  if (!problem.empty()) return nullptr;
  auto server = std::make_unique<Server>(size, std::move(say));
  problem = server->start();
  if (!problem.empty()) return nullptr;
  return std::unique_ptr<Window>(new Window(std::move(server)));
}

Window::Window(std::unique_ptr<Server> server) : server_(std::move(server)) {}
Window::~Window() = default;
void Window::show(Shown shown) { server_->show(std::move(shown)); }
void Window::bind(const std::string& event, const std::string& command) { server_->bind(event, command); }
bool Window::unbind(const std::string& event) { return server_->unbind(event); }
Window::State Window::state() const { return server_->state(); }
long long Window::pictures() const { return server_->pictures(); }

}  // namespace render
