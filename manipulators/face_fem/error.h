#pragma once

#include <cassert>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace face {

/// What is wrong with a model, a file or a load: one name for each way in which a finite element face can fail.
enum class Fault {
  io,             ///< a file cannot be read or written
  syntax,         ///< a line is not what the format says
  truncated,      ///< a file ends too early
  unknown,        ///< a node, element, set, material or word that is not there
  not_finite,     ///< NaN or infinity in the input
  material,       ///< E <= 0, nu outside (-1, 0.5), negative density
  element,        ///< too few or too many nodes, a node twice, the wrong kind
  numbering,      ///< the element's nodes are listed inside out
  inverted,       ///< a Jacobian that is not positive at a corner or a point
  mesh,           ///< faces shared by more than two elements, nodes hanging on faces
  unsupported,    ///< a component that can still move as a rigid body
  zero_mode,      ///< an element with spare modes that nothing restrains
  indefinite,     ///< the factorisation met a pivot that is not positive
  conditioning,   ///< reciprocal condition below 1e-12: the answer would have no digits
  missed_sphere,  ///< a muscle end outside all tissue
  muscle,         ///< a muscle without direction, force ends or with a negative radius
  load,           ///< a load on nothing
  limit,          ///< too large for this program
  landmark,       ///< a part of the face that cannot be found on a head
};

/// The word of a fault: "inverted", "missed_sphere" ...
std::string_view name_of(Fault fault);

/// A refusal: its fault and one sentence naming the place (file:line:column where there is one), the thing, the
/// expectation and the value.
struct Error {
  Fault fault;
  std::string sentence;
  int node = -1;  ///< index of the node it happened at, where there is one and only its index is known
};

/// A value or the error that took its place, in the shape of std::expected.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& operator*() { return *get(); }
  const T& operator*() const { return *const_cast<Result*>(this)->get(); }
  T* operator->() { return get(); }
  const T* operator->() const { return const_cast<Result*>(this)->get(); }
  const Error& error() const {
    assert(!ok());
    return *std::get_if<1>(&content_);
  }

 private:
  T* get() {
    assert(ok());
    return std::get_if<0>(&content_);
  }

  std::variant<T, Error> content_;
};

/// Success without a value, or an error.
using Status = Result<std::monostate>;
inline Status success() { return std::monostate{}; }

}  // namespace face
