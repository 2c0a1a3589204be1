#include "manipulators/eye_control/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <istream>
#include <limits>

namespace eye {

using objdb::Error;
using objdb::ErrorKind;
using objdb::Result;

namespace {

struct Cell {
  std::string_view text;
  int column;
};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<Cell> split(std::string_view line) {
  std::vector<Cell> cells;
  size_t begin = 0;
  while (true) {
    const size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back({trimmed(line.substr(begin, end - begin)), static_cast<int>(begin) + 1});
    if (end == line.size()) return cells;
    begin = end + 1;
  }
}

}  // namespace

int Table::column(std::string_view name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
}

Error cell_error(const std::string& name, int line, int column, ErrorKind kind, const std::string& sentence) {
  const std::string place = name + ":" + std::to_string(line) + ":" + std::to_string(column);
  return {kind, place + ": error " + std::string(objdb::name_of(kind)) + " " + sentence, column};
}

namespace {

// what is wrong with the names of the columns, or nothing
std::string header_fault(const std::vector<std::string>& columns, std::span<const std::string_view> needed) {
  for (size_t k = 1; k < columns.size(); ++k) {
    const auto end = columns.begin() + static_cast<std::ptrdiff_t>(k);
    if (std::find(columns.begin(), end, columns[k]) != end) return "column " + columns[k] + " is there twice";
  }
  std::string all;
  for (std::string_view name : needed) all += (all.empty() ? "" : ",") + std::string(name);
  for (std::string_view name : needed) {
    if (std::find(columns.begin(), columns.end(), name) != columns.end()) continue;
    return "column " + std::string(name) + " is missing, expected a first line " + all;
  }
  return {};
}

}  // namespace

Result<Table> read_table(std::istream& in, const std::string& name, std::span<const std::string_view> needed) {
  Table table;
  std::string line;
  int number = 0;
  while (std::getline(in, line)) {
    number += 1;
    // some programs begin a file with a byte order mark
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;

    const std::vector<Cell> cells = split(line);
    if (table.columns.empty()) {
      for (const Cell& cell : cells) table.columns.emplace_back(cell.text);
      const std::string fault = header_fault(table.columns, needed);
      if (!fault.empty()) return cell_error(name, number, 1, ErrorKind::unknown, fault);
      continue;
    }
    if (cells.size() != table.columns.size()) {
      return cell_error(name, number, 1, ErrorKind::syntax,
                        "the line has " + std::to_string(cells.size()) + " cells, the header " +
                            std::to_string(table.columns.size()));
    }
    std::vector<double> row;
    std::vector<int> places;
    for (size_t k = 0; k < cells.size(); ++k) {
      const std::string_view text = cells[k].text;
      double value = std::numeric_limits<double>::quiet_NaN();
      if (!text.empty()) {
        const char* begin = text.data() + (text.front() == '+');
        const auto [end, status] = std::from_chars(begin, text.data() + text.size(), value);
        if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
          return cell_error(name, number, cells[k].column, ErrorKind::type,
                            table.columns[k] + " must be a finite number, not '" + std::string(text) + "'");
        }
      }
      row.push_back(value);
      places.push_back(cells[k].column);
    }
    table.rows.push_back(std::move(row));
    table.lines.push_back(number);
    table.places.push_back(std::move(places));
  }
  if (table.columns.empty()) return cell_error(name, 1, 1, ErrorKind::syntax, "the table is empty, expected a header");
  return table;
}

Result<Table> read_table_file(const std::string& path, std::span<const std::string_view> needed) {
  std::ifstream in(path);
  if (!in || in.peek() == std::ifstream::traits_type::eof()) {
    const bool opened = in.is_open();
    return cell_error(path, 1, 1, ErrorKind::io,
                      opened ? "the file is empty or cannot be read" : "the file cannot be opened");
  }
  return read_table(in, path, needed);
}

}  // namespace eye
