#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace mesh {

/// Why an operation on the user's data failed: one word of the language's error kinds
/// (`io syntax range type unknown limit`) and one sentence naming the thing, the expectation and the value.
struct Error {
  std::string kind;
  std::string sentence;
};

/// A value or an error, in the shape of std::expected.
template <class T>
class Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const { return state_.index() == 0; }
  bool has_value() const { return state_.index() == 0; }

  /// The value; calling it on an error is our own mistake.
  T& operator*() { return *value_or_null(); }
  const T& operator*() const { return *const_cast<Result*>(this)->value_or_null(); }
  T* operator->() { return value_or_null(); }
  const T* operator->() const { return const_cast<Result*>(this)->value_or_null(); }

  /// The error; calling it on a value is our own mistake.
  const Error& error() const {
    assert(state_.index() == 1);
    return *std::get_if<1>(&state_);
  }

 private:
  T* value_or_null() {
    assert(state_.index() == 0);
    return std::get_if<0>(&state_);
  }

  std::variant<T, Error> state_;
};

}  // namespace mesh
