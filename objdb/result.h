#pragma once

#include <cassert>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace objdb {

/// What is wrong with a line, as the word that stands in its answer.
enum class ErrorKind : std::uint8_t {
  syntax,
  unknown,
  exists,
  type,
  unit,
  range,
  owner,
  busy,
  timeout,
  gone,
  limit,
  io
};

/// The word of a kind: "syntax", "unknown" ...
std::string_view name_of(ErrorKind kind);

/// A refusal: its kind, one sentence that names the thing, the expectation and the value, and the column (1-based
/// byte of the line) of the word at fault; 0 when the line as a whole is meant.
struct Error {
  ErrorKind kind;
  std::string sentence;
  int column = 0;
};

/// A value or the error that took its place; the shape of std::expected, which g++ 12 has not.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& value() {
    assert(ok());
    return *std::get_if<0>(&content_);
  }
  const T& value() const {
    assert(ok());
    return *std::get_if<0>(&content_);
  }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const Error& error() const {
    assert(!ok());
    return *std::get_if<1>(&content_);
  }

 private:
  std::variant<T, Error> content_;
};

/// Success without a value, or an error. A success is a null pointer, so that it costs nothing to hand on.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::make_unique<Error>(std::move(error))) {}
  Result(const Result& other) : error_(other.ok() ? nullptr : std::make_unique<Error>(*other.error_)) {}
  Result(Result&&) = default;
  Result& operator=(const Result& other) { return *this = Result(other); }
  Result& operator=(Result&&) = default;

  bool ok() const { return error_ == nullptr; }
  explicit operator bool() const { return ok(); }
  const Error& error() const {
    assert(!ok());
    return *error_;
  }

 private:
  std::unique_ptr<Error> error_;
};

using Status = Result<void>;

}  // namespace objdb
