#include "manipulators/kinematics/table.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace kinematics {

using objdb::Error;
using objdb::ErrorKind;
using objdb::Result;

Error refusal(const std::string& file, int line, int column, ErrorKind kind, const std::string& what) {
  std::ostringstream out;
  out << file << ':';
  if (line > 0) out << line << ':' << column << ':';
  out << " error " << objdb::name_of(kind) << ' ' << what;
  return {kind, out.str(), column};
}

namespace {

constexpr std::string_view blanks = " \t";

Row split(std::string_view text, int line) {
  Row row{line, {}};
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    std::size_t first = std::min(text.find_first_not_of(blanks, begin), comma);
    std::size_t last = comma;
    while (last > first && blanks.find(text[last - 1]) != std::string_view::npos) --last;
    row.cells.push_back({std::string(text.substr(first, last - first)), static_cast<int>(first) + 1});
    if (comma == text.size()) return row;
    begin = comma + 1;
  }
}

}  // namespace

int Table::column(std::string_view name) const {
  for (std::size_t i = 0; i < header.cells.size(); ++i) {
    if (header.cells[i].text == name) return static_cast<int>(i);
  }
  return -1;
}

Result<Table> parse_table(const std::string& file, std::string_view text) {
  Table table;
  table.file = file;
  int line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view here = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (here.ends_with('\r')) here.remove_suffix(1);
    for (std::size_t i = 0; i < here.size(); ++i) {
      const unsigned char c = here[i];
      if ((c < 32 && c != '\t') || c == 127) {
        return refusal(file, line, static_cast<int>(i) + 1, ErrorKind::syntax,
                       "control byte " + std::to_string(c) + " in a table");
      }
    }
    const std::size_t first = here.find_first_not_of(blanks);
    if (first == std::string_view::npos || here[first] == '#') continue;
    if (table.header.cells.empty()) {
      table.header = split(here, line);
    } else {
      table.rows.push_back(split(here, line));
    }
  }
  if (table.header.cells.empty())
    return refusal(file, 1, 1, ErrorKind::syntax, "the file is empty, expected a header line");
  return table;
}

Result<Table> read_table(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  // a folder opens, and reads as an empty file
  std::error_code fault;
  if (std::filesystem::is_directory(file, fault)) in.setstate(std::ios::badbit);
  if (in) text << in.rdbuf();
  if (!in || in.bad()) return refusal(file, 0, 0, ErrorKind::io, "cannot be read");
  return parse_table(file, text.str());
}

Result<double> number(const Table& table, const Row& row, const Cell& cell, std::string_view what) {
  double value = 0;
  const char* first = cell.text.data();
  const char* last = first + cell.text.size();
  if (first != last && *first == '+') ++first;
  const auto [end, fault] = std::from_chars(first, last, value);
  const std::string thing(what);
  if (fault == std::errc::result_out_of_range || (end == last && first != last && !std::isfinite(value))) {
    return refusal(table.file, row.line, cell.column, ErrorKind::range,
                   thing + " is " + cell.text + ", expected a finite number");
  }
  if (end != last || first == last) {
    return refusal(table.file, row.line, cell.column, ErrorKind::syntax,
                   thing + " is \"" + cell.text + "\", expected a number");
  }
  return value;
}

}  // namespace kinematics
