#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "objdb/database.h"

namespace manager {

/// A long array as it is told. It can be told again for as long as this is kept.
struct Frame {
  objdb::ObjectId object = 0;
  std::string path;
  const objdb::Field* field = nullptr;
  objdb::Numbers numbers;
};

/// Appends the lines that tell a program of an array.
using SayFrame = std::function<void(std::string& out, const Frame& frame)>;

/// What a program is told at once: lines, and between them long arrays, for which each life of a program has lines of
/// its own.
struct Tale {
  struct Array {
    std::size_t at = 0;  ///< stands before text[at]
    Frame frame;
  };
  std::string text;
  std::vector<Array> arrays;

  bool empty() const { return text.empty() && arrays.empty(); }
  void append_to(std::string& out, const SayFrame& say) const {
    std::size_t from = 0;
    for (const Array& array : arrays) {
      out.append(text, from, array.at - from);
      say(out, array.frame);
      from = array.at;
    }
    out.append(text, from);
  }
};

}  // namespace manager
