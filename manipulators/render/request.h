#pragma once

#include <optional>
#include <string>
#include <vector>

#include "manipulators/render/canvas.h"
#include "manipulators/render/picture.h"
#include "objdb/database.h"

namespace render {

/// What the words of a verb ask for. Absent parts are left to the view.
struct Request {
  std::vector<std::string> files;
  const objdb::Object* camera = nullptr;
  const objdb::Object* view = nullptr;
  std::optional<Size> size;
  std::optional<Quality> quality;
  std::optional<double> rate;  ///< [Hz]
  std::optional<int> columns;
};

/// Reads `FILE... [from CAMERA] [size WxH] [quality WORD] [with VIEW] [rate HZ] [columns N]` in any order; `allowed`
/// are the keywords this verb knows. Without `with` the first view of the world is taken, if there is one. Errors carry
/// the column of the word at fault: syntax, unknown, type, range, unit.
objdb::Result<Request> parse_request(const objdb::Database& world, objdb::Words words,
                                     std::initializer_list<std::string_view> allowed);

/// "1280x720". Errors: syntax, range.
objdb::Result<Size> parse_size(const objdb::Word& word);

}  // namespace render
