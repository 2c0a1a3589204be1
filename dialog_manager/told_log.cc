#include "dialog_manager/told_log.h"

#include <algorithm>
#include <set>
#include <utility>

namespace manager {
namespace {

using namespace objdb;

// kept without a checkpoint, in bytes; a longer story cannot be told again
constexpr std::size_t longest = 256u << 20;
// lines of changes that are kept at least, before they are replaced by what they led to
constexpr std::size_t least_changes = 256u << 10;

std::size_t bytes_of(const std::optional<Frame>& frame) { return frame ? frame->numbers.span().size_bytes() : 0; }

}  // namespace

void ToldLog::add(Pieces& to, bool act, std::string_view text, std::optional<Frame> frame) {
  to.text += text.size();
  to.frames += bytes_of(frame);
  if (to.pieces.empty() || to.pieces.back().act != act || to.pieces.back().frame) to.pieces.push_back({act, {}, {}});
  to.pieces.back().text += text;
  to.pieces.back().frame = std::move(frame);
}

void ToldLog::drop_frame(Pieces& from, Piece& piece) {
  from.frames -= bytes_of(piece.frame);
  piece.frame.reset();
}

void ToldLog::add(Pieces& to, const Tale& tale) {
  std::size_t from = 0;
  for (const Tale::Array& array : tale.arrays) {
    add(to, false, std::string_view(tale.text).substr(from, array.at - from), array.frame);
    from = array.at;
  }
  if (from < tale.text.size()) add(to, false, std::string_view(tale.text).substr(from), std::nullopt);
}

void ToldLog::world(const Tale& tale) {
  if (lost_ || tale.empty()) return;
  add(since_, tale);
  limit();
}

void ToldLog::act(std::string_view line) {
  if (lost_) return;
  add(since_, true, line, std::nullopt);
  limit();
}

void ToldLog::limit() {
  if (bytes() > longest) lose();
}

bool ToldLog::wants_whole() const {
  // of arrays only the last is kept, however often they change
  return changes_.text + since_.text > std::max(least_changes, whole_.text + own_.text);
}

void ToldLog::checkpoint(const Tale& own, const Tale* whole) {
  if (whole != nullptr) {
    whole_ = changes_ = {};
    add(whole_, *whole);
  } else {
    // of an array that was told several times only the last counts
    std::set<std::string, std::less<>> later;
    for (Pieces* all : {&since_, &changes_})
      for (auto piece = all->pieces.rbegin(); piece != all->pieces.rend(); ++piece)
        if (piece->frame && !later.insert(piece->frame->path + "." + piece->frame->field->name).second)
          drop_frame(*all, *piece);
    for (Piece& piece : since_.pieces)
      if (!piece.act) add(changes_, false, piece.text, std::move(piece.frame));
  }
  own_ = since_ = {};
  add(own_, own);
}

std::string ToldLog::retell(const SayFrame& say) const {
  std::string out;
  for (const Pieces* all : {&whole_, &changes_, &own_, &since_})
    for (const Piece& piece : all->pieces) {
      out += piece.text;
      if (piece.frame) say(out, *piece.frame);
    }
  return out;
}

}  // namespace manager
