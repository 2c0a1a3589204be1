#include "dialog_manager/answer.h"

#include <algorithm>
#include <utility>

#include "dialog_manager/count.h"

namespace manager {
namespace {

using objdb::Error;
using objdb::ErrorKind;
using objdb::Status;

constexpr std::size_t longest = 64u << 20;

}  // namespace

void Answer::expect_tick(std::uint64_t tick) {
  start_over();
  tick_ = tick;
}

void Answer::expect_state() {
  start_over();
  state_ = true;
}

void Answer::abandon() {
  start_over();
  tick_.reset();
  state_ = false;
}

void Answer::start_over() {
  text_.clear();
  whole_ = false;
}

Status Answer::add(std::string_view line) {
  if (text_.size() > longest)
    return Error{ErrorKind::limit, "more than " + std::to_string(longest) + " bytes in one tick", 1};
  text_.append(line).append("\n");
  return {};
}

Status Answer::done(std::string_view line) {
  const std::optional<std::uint64_t> tick = line.size() > 5 ? parse_count(line.substr(5)) : std::nullopt;
  if (state_ && line.size() == 4) {
    state_ = false;
  } else if (tick && tick_ == tick) {
    tick_.reset();
  } else {
    return Error{ErrorKind::range,
                 "done " + std::string(line.substr(std::min<std::size_t>(5, line.size()))) +
                     (tick_    ? ", expected done " + std::to_string(*tick_)
                      : state_ ? ", expected done after a checkpoint"
                               : ", though no tick is under way"),
                 1};
  }
  whole_ = true;
  return {};
}

std::optional<std::string> Answer::take() {
  if (!whole_) return std::nullopt;
  whole_ = false;
  return std::exchange(text_, {});
}

}  // namespace manager
