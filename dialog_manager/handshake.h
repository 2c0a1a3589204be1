#pragma once

#include <string>
#include <string_view>

#include "dialog_manager/declaration.h"

namespace manager {

class Manager;
class Manipulator;

/// The beginning of a program's life: what it hears first, and what it declares until it says `ready`.
class Handshake {
 public:
  Handshake(Manager& manager, const Manipulator& program) : manager_(manager), program_(program) {}

  /// A life begins. The line that it hears: the same for every life of the program.
  const std::string& begin();
  /// One line that it says: is it `ready`? The error is the end of this life: syntax, unknown, type, unit, range,
  /// exists (what it brings is there already, and different).
  objdb::Result<bool> take(std::string_view line);
  /// What it has declared in this life.
  Declaration& declared() { return declaring_; }

 private:
  objdb::Result<bool> declare(objdb::Words words, std::string_view line);
  objdb::Status free_verb(const objdb::Word& name) const;

  Manager& manager_;
  const Manipulator& program_;
  std::string hello_;
  Declaration declaring_;
  objdb::LineWords words_;
};

}  // namespace manager
