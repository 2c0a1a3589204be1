#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "objdb/result.h"

namespace kinematics {

/// A refusal that knows its place: the sentence reads `FILE:LINE:COLUMN: error KIND what`.
objdb::Error refusal(const std::string& file, int line, int column, objdb::ErrorKind kind, const std::string& what);

/// One cell of a comma separated table and where it stands (column is the 1-based byte of its line).
struct Cell {
  std::string text;
  int column = 1;
};

struct Row {
  int line = 0;  ///< 1-based
  std::vector<Cell> cells;
};

/// A comma separated file with a header. Blank lines and lines that start with # are left out; blanks around a cell are
/// cut; \r\n is read as \n. No quoting: every cell is a number or a name.
struct Table {
  std::string file;
  Row header;
  std::vector<Row> rows;

  /// Position of a header name, -1 when it is missing.
  int column(std::string_view name) const;
};

/// Reads a table. Errors: io (cannot be read), syntax (no header, control bytes).
objdb::Result<Table> read_table(const std::string& file);
objdb::Result<Table> parse_table(const std::string& file, std::string_view text);

/// A finite number. Errors: syntax (not a number), range (infinite or not a number).
objdb::Result<double> number(const Table& table, const Row& row, const Cell& cell, std::string_view what);

}  // namespace kinematics
