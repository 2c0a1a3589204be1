#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "objdb/result.h"

namespace eye {

/// A table of numbers with named columns, read from text.
struct Table {
  std::vector<std::string> columns;
  /// rows.size() by columns.size(); an empty cell is NaN
  std::vector<std::vector<double>> rows;
  std::vector<int> lines;                ///< line of each row in the file
  std::vector<std::vector<int>> places;  ///< where each cell begins in its line, from 1

  /// Index of a column, or -1.
  int column(std::string_view name) const;
};

/// Reads comma-separated values: one line of names, then numbers; blanks around cells, empty lines and lines that start
/// with # are skipped. `name` is what errors call the text. The error's sentence starts with its place,
/// NAME:LINE:COLUMN, and the word error with its kind. Columns that are `needed` must be there, and none twice.
objdb::Result<Table> read_table(std::istream& in, const std::string& name, std::span<const std::string_view> needed);

/// The same from a file.
objdb::Result<Table> read_table_file(const std::string& path, std::span<const std::string_view> needed);

/// An error about a place in a text.
objdb::Error cell_error(const std::string& name, int line, int column, objdb::ErrorKind kind,
                        const std::string& sentence);

}  // namespace eye
