#include "dialog_manager/told_log.h"

#include <algorithm>
#include <set>

#include "objdb/statement.h"

namespace manager {
namespace {

using namespace objdb;

// kept without a checkpoint, in bytes; a longer story cannot be told again
constexpr std::size_t longest = 256u << 20;
// lines of changes that are kept at least, before they are replaced by what they led to
constexpr std::size_t least_changes = 256u << 10;

std::size_t bytes_of(const Frame* frame) {
  return frame == nullptr ? 0 : std::get<std::vector<double>>(frame->values).size() * sizeof(double);
}

}  // namespace

void ToldLog::add(Pieces& to, bool act, std::string_view text, std::shared_ptr<const Frame> frame) {
  to.bytes += text.size() + bytes_of(frame.get());
  if (to.pieces.empty() || to.pieces.back().act != act || to.pieces.back().frame) to.pieces.push_back({act, {}, {}});
  to.pieces.back().text += text;
  to.pieces.back().frame = std::move(frame);
}

void ToldLog::add(Pieces& to, const Tale& tale) {
  std::size_t from = 0;
  for (const Tale::Put& put : tale.puts) {
    add(to, false, std::string_view(tale.text).substr(from, put.at - from), put.frame);
    from = put.at;
  }
  if (from < tale.text.size()) add(to, false, std::string_view(tale.text).substr(from), nullptr);
}

void ToldLog::world(const Tale& tale) {
  if (lost_ || tale.empty()) return;
  add(since_, tale);
  limit();
}

void ToldLog::act(std::string_view line) {
  if (lost_) return;
  add(since_, true, line, nullptr);
  limit();
}

void ToldLog::limit() {
  if (bytes() <= longest) return;
  begin();
  lost_ = true;
}

bool ToldLog::wants_whole() const {
  return changes_.bytes + since_.bytes > std::max(least_changes, whole_.bytes + own_.bytes);
}

void ToldLog::checkpoint(const Tale& own, const Tale* whole) {
  if (whole != nullptr) {
    whole_ = changes_ = {};
    add(whole_, *whole);
  } else {
    // of an array that was told several times only the last counts
    std::set<std::string, std::less<>> later;
    std::vector<bool> last(since_.pieces.size());
    for (std::size_t i = since_.pieces.size(); i-- > 0;)
      if (const Frame* frame = since_.pieces[i].frame.get())
        last[i] = later.insert(frame->path + "." + frame->field->name).second;
    for (std::size_t i = 0; i < since_.pieces.size(); ++i)
      if (Piece& piece = since_.pieces[i]; !piece.act)
        add(changes_, false, piece.text, last[i] ? std::move(piece.frame) : nullptr);
  }
  own_ = since_ = {};
  add(own_, own);
}

std::string ToldLog::retell(const Names& names) const {
  std::string out;
  for (const Pieces* all : {&whole_, &changes_, &own_, &since_})
    for (const Piece& piece : all->pieces) {
      out += piece.text;
      if (piece.frame) append_set(out, names, piece.frame->path, *piece.frame->field, piece.frame->values);
    }
  return out;
}

}  // namespace manager
