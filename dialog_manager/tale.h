#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "objdb/database.h"

namespace manager {

/// An array as it was told, kept for as long as it may have to be told again.
struct Frame {
  std::string path;
  const objdb::Field* field = nullptr;
  objdb::Value values;  ///< std::vector<double>
};

/// What a program is told at once: lines, and between them arrays that stand in shared memory.
struct Tale {
  /// Stands before text[at]. `line` announces it to the program as it lives now; the memory will hold other numbers
  /// when the tale is told again, from `frame`.
  struct Put {
    std::size_t at = 0;
    std::string line;
    std::shared_ptr<const Frame> frame;
  };
  std::string text;
  std::vector<Put> puts;

  bool empty() const { return text.empty() && puts.empty(); }
  /// The lines as the program reads them now.
  void append_to(std::string& out) const {
    std::size_t from = 0;
    for (const Put& put : puts) {
      out.append(text, from, put.at - from).append(put.line);
      from = put.at;
    }
    out.append(text, from);
  }
};

}  // namespace manager
