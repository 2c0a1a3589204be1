#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace manager {

/// Columns that a text takes on a terminal: wide characters two, control characters as they are shown (^C).
std::size_t width(std::string_view text);

/// Columns of the terminal behind a descriptor; 0 when it is none.
std::size_t terminal_columns(int descriptor);

/// Breaks lines at blanks so that none is wider than `columns`; what a line is indented by, its rest is too. Words that
/// are wider stay whole. 0 columns: as it is.
std::string wrapped(std::string_view text, std::size_t columns);

/// A list in columns, downwards, as narrow as it gets; at most `rows` rows, and how many are left out.
std::string in_columns(const std::vector<std::string>& words, std::size_t columns, std::size_t rows);

}  // namespace manager
