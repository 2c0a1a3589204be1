#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "dialog_manager/briefing.h"
#include "dialog_manager/told_log.h"

namespace manager {

/// All that one program was told: its part of the world as it changes, and what it acted on; kept, so that another life
/// of it can be told the same.
class Story {
 public:
  Story(objdb::Database& world, const Declaration& declaration, std::string serving)
      : briefing_(world, declaration, std::move(serving)) {}

  Briefing& briefing() { return briefing_; }
  const Briefing& briefing() const { return briefing_; }
  bool begun() const { return briefing_.begun(); }

  /// Its words are known by this number: its part of the world, whole.
  Tale begin(std::uint16_t reader);
  /// What changed since, in a tick or (0) outside of one, as Briefing::changes().
  Tale changes(std::uint64_t tick);
  /// What the scene wants, which is told like the world.
  Tale budget(const std::string& line);
  /// A tick or a verb.
  void act(std::string_view line) { log_.act(line); }

  /// It has written down its state: what it was told before need not be told again.
  void checkpoint();
  /// Everything once more, arrays by `say`. When more was told than is kept, the world as it stands, and `act`, what it
  /// is acting on.
  std::string retell(std::string_view act, const SayFrame& say);
  /// What it was told is not to be told again: then the world as it stands.
  void lose() { log_.lose(); }
  /// More was told than is kept.
  bool lost() const { return log_.lost(); }

  /// Bytes that a restart would tell it, and those since the last checkpoint.
  std::size_t bytes() const { return log_.bytes(); }
  std::size_t since() const { return log_.since(); }

 private:
  void forget_the_past();

  Briefing briefing_;
  ToldLog log_;
  std::string budget_;  // as it was told last, "" for never
};

}  // namespace manager
