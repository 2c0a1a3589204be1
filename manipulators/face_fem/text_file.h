#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "manipulators/face_fem/error.h"

namespace face {

/// Text that grows in memory and is written whole. Numbers look the same in every locale.
class TextFile {
 public:
  TextFile& add(std::string_view words) {
    text_ += words;
    return *this;
  }
  TextFile& add(int number) { return put(number); }
  /// Shortest text that reads back as the same bits.
  TextFile& add(double number) { return put(number); }
  /// With `digits` after the point, in scientific form.
  TextFile& add(double number, int digits) { return put(number, std::chars_format::scientific, digits); }

  const std::string& text() const { return text_; }

  /// Writes to `path`, whole or not at all. Error `io`.
  Status write(const std::string& path) const;

 private:
  template <class... Form>
  TextFile& put(Form... form) {
    char digits[40];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, form...).ptr);
    return *this;
  }

  std::string text_;
};

}  // namespace face
