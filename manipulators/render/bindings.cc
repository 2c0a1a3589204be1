#include "manipulators/render/bindings.h"

#include <cmath>
#include <string_view>

#include "objdb/text.h"

namespace render {

std::string Bindings::event_problem(const std::string& event) {
  std::string_view rest = event;
  for (bool more = true; more;) {
    more = false;
    for (std::string_view modifier : {"Shift-", "Control-", "Alt-"}) {
      if (rest.starts_with(modifier)) {
        rest.remove_prefix(modifier.size());
        more = true;
      }
    }
  }
  const bool is_key = rest.starts_with("Key-") && rest.size() > 4;
  bool is_button = rest == "Wheel-up" || rest == "Wheel-down";
  for (std::string_view button : {"Button1", "Button2", "Button3"}) {
    is_button = is_button || rest == button || rest == std::string(button) + "-drag";
  }
  if (is_key || is_button) return {};
  return "expected an event like Key-space, Shift-Key-r, Button1, Button3-drag or Wheel-up, is " + objdb::shown(event);
}

std::string Bindings::command(const Gesture& gesture) const {
  const auto found = commands_.find(gesture.event);
  if (found == commands_.end()) return {};
  std::string line;
  const std::string& pattern = found->second;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] != '%') {
      line += pattern[i];
      continue;
    }
    const std::string_view rest = std::string_view(pattern).substr(i + 1);
    if (rest.starts_with("path")) {
      if (gesture.path.empty()) return {};
      line += gesture.path;
      i += 4;
    } else if (rest.starts_with("event")) {
      line += gesture.event;
      i += 5;
    } else if (!rest.empty() && rest[0] >= 'x' && rest[0] <= 'z') {
      if (!gesture.has_point) return {};
      objdb::append_number(line, std::round(gesture.point[rest[0] - 'x'] * 1e4) / 1e4);
      i += 1;
    } else {
      line += '%';
      i += rest.starts_with("%") ? 1 : 0;
    }
  }
  return line;
}

}  // namespace render
