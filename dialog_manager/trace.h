#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "objdb/statement.h"

namespace manager {

/// A CSV file of values over simulated time: a header with units (`t_s,ball.position_x_m`), then a row now and after
/// every tick, or every `period` seconds. Which objects are traced is settled at the start; the cells of one that is
/// deleted stay empty.
class Trace {
 public:
  /// Errors: unknown (a pattern without match), io.
  static objdb::Result<std::unique_ptr<Trace>> open(const std::string& path, const objdb::Database& world,
                                                    objdb::Words patterns, const objdb::Scope& scope, double time,
                                                    double period);
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  /// Error io: the file cannot be written any more.
  objdb::Status tick(const objdb::Database& world, double time);
  const std::string& path() const { return path_; }

 private:
  struct Column {
    objdb::ObjectId object;
    int field;
  };
  Trace() = default;
  objdb::Status header(const objdb::Database& world);
  objdb::Status write(const std::string& line);
  objdb::Status row(const objdb::Database& world, double time);

  std::string path_;
  std::FILE* file_ = nullptr;
  std::vector<Column> columns_;
  std::vector<std::size_t> cells_;  // of each column
  double start_ = 0, period_ = 0;
  std::uint64_t rows_ = 0;
};

}  // namespace manager
