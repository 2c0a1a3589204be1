#pragma once

#include <string>

#include "objdb/statement.h"

namespace manager {

class Manipulator;
class Manager;

/// What a program may write and make: what it declared, of the objects that it serves, and no field that another
/// program writes. Who writes a field first owns it.
class Rights : public objdb::Gate {
 public:
  Rights(Manager& manager, Manipulator& program) : manager_(manager), program_(program) {}

  /// Errors: owner.
  objdb::Status may_write(const objdb::Object& object, int field) override;
  objdb::Status may_make(const objdb::Object& object) override;

 private:
  bool declared(const objdb::Object& object, const objdb::Field* field) const;
  objdb::Error not_served(const objdb::Object& object) const;

  Manager& manager_;
  Manipulator& program_;
};

}  // namespace manager
