#include "dialog_manager/story.h"

namespace manager {

Tale Story::begin(std::uint16_t reader) {
  Tale tale;
  briefing_.begin(reader, tale);
  log_.world(tale);
  return tale;
}

Tale Story::changes(std::uint64_t tick) {
  Tale tale;
  if (!begun()) return tale;
  briefing_.changes(tale, tick);
  log_.world(tale);
  return tale;
}

Tale Story::budget(const std::string& line) {
  budget_ = line + "\n";
  Tale tale{budget_, {}};
  log_.world(tale);
  return tale;
}

void Story::checkpoint() {
  if (log_.lost() || log_.wants_whole()) {
    forget_the_past();
    return;
  }
  Tale own;
  briefing_.own(own);
  log_.checkpoint(own, nullptr);
}

// its part of the world as it stands, in the place of all that it was told
void Story::forget_the_past() {
  Tale whole{budget_, {}}, own;
  briefing_.whole(whole);
  briefing_.own(own);
  log_.begin();
  log_.checkpoint(own, &whole);
}

std::string Story::retell(std::string_view act, const SayFrame& say) {
  if (log_.lost()) {
    forget_the_past();
    log_.act(act);
  }
  return log_.retell(say);
}

}  // namespace manager
