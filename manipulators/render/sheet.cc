#include "manipulators/render/sheet.h"

#include <algorithm>
#include <cmath>

#include "manipulators/render/text.h"

namespace render {

std::string contact_sheet(const std::vector<SheetItem>& items, int columns, Size cell, Picture& sheet) {
  if (items.empty()) return "a contact sheet needs at least one picture";
  const int count = static_cast<int>(items.size());
  if (columns < 1) columns = static_cast<int>(std::ceil(std::sqrt(count)));
  columns = std::min(columns, count);
  const int rows = (count + columns - 1) / columns;
  const int text = std::max(12, cell.height / 16);
  const int gap = std::max(4, cell.width / 40);
  const Size whole{columns * (cell.width + gap) + gap, rows * (cell.height + text + 2 * gap) + gap};
  if (std::string problem = size_problem(whole); !problem.empty()) return problem;

  sheet = Picture(whole, {44, 50, 60, 255});
  for (int i = 0; i < count; ++i) {
    const Picture& from = items[static_cast<std::size_t>(i)].picture;
    if (from.width() == 0 || from.height() == 0) continue;
    const double shrink =
        std::min(static_cast<double>(cell.width) / from.width(), static_cast<double>(cell.height) / from.height());
    const Size fitted{std::max(1, static_cast<int>(from.width() * shrink)),
                      std::max(1, static_cast<int>(from.height() * shrink))};
    const int x = gap + i % columns * (cell.width + gap);
    const int y = gap + i / columns * (cell.height + text + 2 * gap);
    paste(fitted == from.size() ? from : resized(from, fitted), sheet, x + (cell.width - fitted.width) / 2,
          y + (cell.height - fitted.height) / 2);
    // names longer than the cell keep their end, where they differ
    std::string name = items[static_cast<std::size_t>(i)].name;
    while (name.size() > 4 && text_width(name, text) > cell.width) name = ".." + name.substr(4);
    write_text(sheet, name, x + (cell.width - text_width(name, text)) / 2, y + cell.height + gap / 2, text,
               {255, 255, 255, 255});
  }
  return {};
}

}  // namespace render
