#include "dialog_manager/requests.h"

#include <algorithm>

#include "dialog_manager/count.h"

namespace manager {
namespace {

using namespace objdb;

// "error KIND [COLUMN] sentence" as a program says it
Error parse_error(std::string_view text) {
  text.remove_prefix(std::min<std::size_t>(6, text.size()));
  Error error{ErrorKind::io, std::string(text), 0};
  for (int kind = 0; kind <= static_cast<int>(ErrorKind::io); ++kind) {
    const std::string_view word = name_of(static_cast<ErrorKind>(kind));
    if (!text.starts_with(word) || text.size() <= word.size() || text[word.size()] != ' ') continue;
    error.kind = static_cast<ErrorKind>(kind);
    error.sentence = text.substr(word.size() + 1);
    // an optional column of the forwarded line
    const std::size_t digits = error.sentence.find_first_not_of("0123456789");
    if (digits != 0 && digits != std::string::npos && error.sentence[digits] == ' ') {
      error.column = static_cast<int>(parse_count(std::string_view(error.sentence).substr(0, digits)).value_or(0));
      error.sentence.erase(0, digits + 1);
    }
    break;
  }
  return error;
}

}  // namespace

std::optional<std::uint64_t> request_number(std::string_view line) {
  const std::string_view tag = line.substr(0, line.find(' '));
  return parse_count(tag.substr(1));
}

std::uint64_t Requests::add() {
  sent_.emplace_back(next_, std::nullopt);
  return next_++;
}

std::size_t Requests::waiting() const {
  return static_cast<std::size_t>(
      std::count_if(sent_.begin(), sent_.end(), [](const auto& each) { return !each.second; }));
}

bool Requests::close(std::string_view line) {
  std::string body = std::exchange(body_, {});
  const std::optional<std::uint64_t> number = request_number(line);
  const auto sent = std::find_if(sent_.begin(), sent_.end(),
                                 [&](const auto& each) { return number && each.first == *number && !each.second; });
  if (sent == sent_.end()) return false;
  const std::size_t blank = line.find(' ');
  const std::string_view rest = blank == std::string_view::npos ? std::string_view() : line.substr(blank + 1);
  sent->second = Reply{std::move(body), rest.starts_with("error") ? Status(parse_error(rest)) : Status()};
  return true;
}

void Requests::fail(const Error& error) {
  for (auto& [number, reply] : sent_)
    if (!reply) reply = Reply{{}, error};
}

bool Requests::has(std::uint64_t number) const {
  return std::any_of(sent_.begin(), sent_.end(), [&](const auto& each) { return each.first == number; });
}

std::optional<Requests::Reply> Requests::take(std::uint64_t number) {
  const auto sent = std::find_if(sent_.begin(), sent_.end(), [&](const auto& each) { return each.first == number; });
  if (sent == sent_.end() || !sent->second) return std::nullopt;
  Reply reply = std::move(*sent->second);
  sent_.erase(sent);
  return reply;
}

}  // namespace manager
