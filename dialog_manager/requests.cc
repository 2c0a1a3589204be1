#include "dialog_manager/requests.h"

#include <algorithm>

#include "dialog_manager/count.h"
#include "dialog_manager/said_error.h"

namespace manager {

using namespace objdb;

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
  sent->second = Reply{std::move(body), rest.starts_with("error") ? Status(parse_said_error(rest)) : Status()};
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
