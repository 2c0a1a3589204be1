#pragma once

#include <string>
#include <vector>

#include "manipulators/render/picture.h"

namespace render {

struct SheetItem {
  Picture picture;
  std::string name;
};

/// A contact sheet: the pictures in rows of `columns`, each fitted into a cell with its name below.
/// columns 0: about as wide as high. Errors in words: no pictures, too large.
std::string contact_sheet(const std::vector<SheetItem>& items, int columns, Size cell, Picture& sheet);

}  // namespace render
