#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dialog_manager/tale.h"

namespace manager {

/// What a program was told, so that another life of it can be told the same. Until the first checkpoint that is every
/// line. A checkpoint takes the place of all that the program acted on before: what is kept of that time are the lines
/// that make its part of the world, and when these have grown to twice what its part of the world takes, that instead.
/// So its size, and the time to tell it, do not grow with the length of a run.
class ToldLog {
 public:
  /// Lines that make or change the program's part of the world.
  void world(const Tale& tale);
  /// A line that it acts on: a tick, a verb.
  void act(std::string_view line);

  /// It has written down its state: `own` are the values that it wrote itself. `whole` is its part of the world anew,
  /// given when wants_whole() said so.
  void checkpoint(const Tale& own, const Tale* whole);
  bool wants_whole() const;

  /// Everything once more.
  std::string retell(const SayFrame& say) const;

  /// Bytes told since the last checkpoint, and all that are kept.
  std::size_t since() const { return size_of(since_); }
  std::size_t bytes() const { return size_of(whole_) + size_of(changes_) + size_of(own_) + size_of(since_); }
  /// More than is kept was told without a checkpoint; the log is empty and stays so until begin().
  bool lost() const { return lost_; }
  void begin() { *this = {}; }
  void lose() {
    begin();
    lost_ = true;
  }

 private:
  struct Piece {
    bool act = false;
    std::string text;
    std::optional<Frame> frame;  // stands behind the text
  };
  struct Pieces {
    std::vector<Piece> pieces;
    std::size_t text = 0, frames = 0;  // bytes
  };
  static std::size_t size_of(const Pieces& all) { return all.text + all.frames; }
  static void drop_frame(Pieces& from, Piece& piece);
  static void add(Pieces& to, bool act, std::string_view text, std::optional<Frame> frame);
  static void add(Pieces& to, const Tale& tale);
  void limit();

  Pieces whole_, changes_, own_, since_;
  bool lost_ = false;
};

}  // namespace manager
