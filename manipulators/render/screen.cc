#include "manipulators/render/screen.h"

#include <X11/XKBlib.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XShm.h>
#include <poll.h>
#include <sys/ipc.h>
#include <sys/shm.h>
#include <unistd.h>

#include <cstring>

namespace render {

namespace {

// Xlib reports a failed request (a refused shared segment, say) through a function, not a value
int refused = 0;
int note_refusal(Display*, XErrorEvent*) {
  refused = 1;
  return 0;
}

std::string modifiers_of(unsigned state) {
  std::string words;
  if (state & ShiftMask) words += "Shift-";
  if (state & ControlMask) words += "Control-";
  if (state & Mod1Mask) words += "Alt-";
  return words;
}

class X11Screen : public Screen {
 public:
  X11Screen(Display* display, Size size, const std::string& title) : display_(display) {
    // both have to be replaced for the program to outlive its X server: one complains, the other ends it
    XSetIOErrorHandler([](Display*) { return 0; });
    XSetIOErrorExitHandler(
        display_, [](Display*, void* self) { static_cast<X11Screen*>(self)->alive_ = false; }, this);
    const int screen = DefaultScreen(display_);
    window_ = XCreateSimpleWindow(display_, RootWindow(display_, screen), 0, 0, static_cast<unsigned>(size.width),
                                  static_cast<unsigned>(size.height), 0, 0, BlackPixel(display_, screen));
    XStoreName(display_, window_, title.c_str());
    close_ = XInternAtom(display_, "WM_DELETE_WINDOW", False);
    XSetWMProtocols(display_, window_, &close_, 1);
    XSelectInput(
        display_, window_,
        ExposureMask | KeyPressMask | ButtonPressMask | ButtonReleaseMask | PointerMotionMask | StructureNotifyMask);
    context_ = XCreateGC(display_, window_, 0, nullptr);
    // pictures cover everything: no flash of background when it grows
    XSetWindowBackgroundPixmap(display_, window_, None);
    XMapWindow(display_, window_);
    XSync(display_, False);
    shared_ = XShmQueryExtension(display_) != 0;
  }

  ~X11Screen() override {
    release_image();
    if (alive_) {
      XFreeGC(display_, context_);
      XDestroyWindow(display_, window_);
    }
    // after the server's death closing would only wait for it; the socket is all there is to give back
    if (alive_) {
      XCloseDisplay(display_);
    } else {
      ::close(ConnectionNumber(display_));
    }
  }

  bool alive() const override { return alive_; }

  std::vector<ScreenEvent> events(int wake, int milliseconds) override {
    std::vector<ScreenEvent> happened;
    if (!alive_) return happened;
    if (XPending(display_) == 0 && alive_) {
      pollfd watched[2] = {{ConnectionNumber(display_), POLLIN, 0}, {wake, POLLIN, 0}};
      poll(watched, 2, milliseconds);
      char bytes[64];
      if (watched[1].revents & POLLIN) {
        while (read(wake, bytes, sizeof bytes) == static_cast<ssize_t>(sizeof bytes)) continue;
      }
    }
    while (alive_ && XPending(display_) > 0) {
      XEvent event;
      XNextEvent(display_, &event);
      if (alive_) translate(event, happened);
    }
    return happened;
  }

  void put(const Picture& picture) override {
    if (!alive_ || !image_for(picture.size())) return;
    // the visual's bytes are blue, green, red, unused
    const std::uint8_t* from = picture.data();
    for (int y = 0; y < picture.height(); ++y) {
      auto* to =
          reinterpret_cast<std::uint32_t*>(image_->data + static_cast<std::ptrdiff_t>(y) * image_->bytes_per_line);
      for (int x = 0; x < picture.width(); ++x, from += 4) {
        to[x] = static_cast<std::uint32_t>(from[0]) << 16 | static_cast<std::uint32_t>(from[1]) << 8 | from[2];
      }
    }
    if (segment_.shmaddr) {
      XShmPutImage(display_, window_, context_, image_, 0, 0, 0, 0, static_cast<unsigned>(picture.width()),
                   static_cast<unsigned>(picture.height()), False);
    } else {
      XPutImage(display_, window_, context_, image_, 0, 0, 0, 0, static_cast<unsigned>(picture.width()),
                static_cast<unsigned>(picture.height()));
    }
    // the server must have read the image before the next one is written into it
    XSync(display_, False);
  }

 private:
  void release_image() {
    if (segment_.shmaddr) {
      if (alive_) {
        XShmDetach(display_, &segment_);
        XSync(display_, False);
      }
      if (image_) image_->data = nullptr;
      shmdt(segment_.shmaddr);
      segment_ = {};
    }
    if (image_) XDestroyImage(image_);
    image_ = nullptr;
  }

  // an image of that size, in shared memory if the server takes it
  bool image_for(Size size) {
    if (image_ && image_->width == size.width && image_->height == size.height) return true;
    release_image();
    const int screen = DefaultScreen(display_);
    Visual* visual = DefaultVisual(display_, screen);
    const auto depth = static_cast<unsigned>(DefaultDepth(display_, screen));
    const auto width = static_cast<unsigned>(size.width);
    const auto height = static_cast<unsigned>(size.height);
    if (shared_) {
      image_ = XShmCreateImage(display_, visual, depth, ZPixmap, nullptr, &segment_, width, height);
      const std::size_t bytes = image_ ? static_cast<std::size_t>(image_->bytes_per_line) * height : 0;
      const int id = image_ ? shmget(IPC_PRIVATE, bytes, IPC_CREAT | 0600) : -1;
      void* address = id >= 0 ? shmat(id, nullptr, 0) : reinterpret_cast<void*>(-1);
      if (address != reinterpret_cast<void*>(-1)) {
        segment_.shmid = id;
        segment_.shmaddr = image_->data = static_cast<char*>(address);
        segment_.readOnly = False;
        refused = 0;
        auto before = XSetErrorHandler(note_refusal);
        XShmAttach(display_, &segment_);
        XSync(display_, False);
        XSetErrorHandler(before);
      }
      // once both sides are attached the segment goes away with the last of them, whatever happens
      if (id >= 0) shmctl(id, IPC_RMID, nullptr);
      if (segment_.shmaddr && !refused) return alive_;
      // a server on another machine, or without room
      shared_ = false;
      if (image_) image_->data = nullptr;
      if (segment_.shmaddr) shmdt(segment_.shmaddr);
      segment_ = {};
      if (image_) XDestroyImage(image_);
      image_ = nullptr;
    }
    auto* data = static_cast<char*>(std::malloc(static_cast<std::size_t>(width) * height * 4));
    image_ = XCreateImage(display_, visual, depth, ZPixmap, 0, data, width, height, 32, 0);
    return image_ && alive_;
  }

  void translate(XEvent& event, std::vector<ScreenEvent>& happened) {
    ScreenEvent out{};
    switch (event.type) {
      case KeyPress: {
        out.kind = ScreenEvent::Kind::key;
        const KeySym symbol = XkbKeycodeToKeysym(display_, static_cast<KeyCode>(event.xkey.keycode), 0, 0);
        const char* name = XKeysymToString(symbol);
        if (!name) return;
        out.name = name;
        out.modifiers = modifiers_of(event.xkey.state);
        // an event that another program sent does not know where the pointer is
        ::Window root = 0, child = 0;
        int root_x = 0, root_y = 0, x = 0, y = 0;
        unsigned mask = 0;
        XQueryPointer(display_, window_, &root, &child, &root_x, &root_y, &x, &y, &mask);
        out.x = static_cast<float>(x);
        out.y = static_cast<float>(y);
        break;
      }
      case ButtonPress:
      case ButtonRelease: {
        static const char* names[] = {"", "Button1", "Button2", "Button3", "Wheel-up", "Wheel-down"};
        if (event.xbutton.button < 1 || event.xbutton.button > 5) return;
        out.kind = event.type == ButtonPress ? ScreenEvent::Kind::press : ScreenEvent::Kind::release;
        out.name = names[event.xbutton.button];
        out.modifiers = modifiers_of(event.xbutton.state);
        out.x = static_cast<float>(event.xbutton.x);
        out.y = static_cast<float>(event.xbutton.y);
        break;
      }
      case MotionNotify:
        out.kind = ScreenEvent::Kind::motion;
        out.modifiers = modifiers_of(event.xmotion.state);
        out.x = static_cast<float>(event.xmotion.x);
        out.y = static_cast<float>(event.xmotion.y);
        out.button[1] = (event.xmotion.state & Button1Mask) != 0;
        out.button[2] = (event.xmotion.state & Button2Mask) != 0;
        out.button[3] = (event.xmotion.state & Button3Mask) != 0;
        if (!happened.empty() && happened.back().kind == ScreenEvent::Kind::motion) happened.pop_back();
        break;
      case ConfigureNotify:
        out.kind = ScreenEvent::Kind::resize;
        out.size = {event.xconfigure.width, event.xconfigure.height};
        break;
      case Expose:
        if (event.xexpose.count > 0) return;
        out.kind = ScreenEvent::Kind::expose;
        break;
      case ClientMessage:
        if (static_cast<Atom>(event.xclient.data.l[0]) != close_) return;
        out.kind = ScreenEvent::Kind::close;
        break;
      default: return;
    }
    happened.push_back(out);
  }

  Display* display_;
  bool alive_ = true;
  ::Window window_ = 0;
  GC context_ = nullptr;
  Atom close_ = 0;
  bool shared_ = false;
  XShmSegmentInfo segment_{};
  XImage* image_ = nullptr;
};

}  // namespace

std::unique_ptr<Screen> Screen::open(Size size, const std::string& title, std::string& problem) {
  problem = size_problem(size);
  if (!problem.empty()) return nullptr;
  const char* name = std::getenv("DISPLAY");
  Display* display = XOpenDisplay(nullptr);
  if (!display) {
    problem = name && *name ? std::string("the X display ") + name + " cannot be opened"
                            : "the environment variable DISPLAY names no X display";
    return nullptr;
  }
  const int screen = DefaultScreen(display);
  Visual* visual = DefaultVisual(display, screen);
  if (DefaultDepth(display, screen) < 24 || visual->red_mask != 0xff0000 || visual->blue_mask != 0xff) {
    XCloseDisplay(display);
    problem = "the X display has no 24-bit colour";
    return nullptr;
  }
  return std::make_unique<X11Screen>(display, size, title);
}

}  // namespace render
