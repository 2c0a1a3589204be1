#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dialog_manager/session.h"

namespace manager {

/// Who speaks beside the main conversation: readers of FIFOs.
class Speakers {
 public:
  explicit Speakers(Manager& manager) : manager_(manager) {}

  /// Reads commands from a FIFO, made with mode 0600 when it is not there. Errors: exists, io, limit.
  objdb::Status listen(const std::string& path);
  /// Error unknown.
  objdb::Status unlisten(const std::string& path);
  const std::vector<std::unique_ptr<Session>>& all() const { return all_; }
  /// The FIFO from its next writer on. Errors: io (gone, no FIFO, not ours), limit.
  objdb::Result<Input> fifo_input(const std::string& path);

  /// Those who were taken away while they spoke are gone now.
  void bury() { ending_.clear(); }
  /// Removes the FIFOs that were made.
  void remove_fifos();

 private:
  Manager& manager_;
  std::vector<std::unique_ptr<Session>> all_, ending_;
  std::vector<std::string> made_;
};

}  // namespace manager
