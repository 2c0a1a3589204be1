#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tsl/robin_map.h>

#include "objdb/field.h"

namespace objdb {

/// A type of objects: a name, a base, and fields. Types only grow: fields are added, never taken away, so an index
/// into fields() stays good for the whole session. A type holds its base's fields too, at indices of its own.
class Type {
 public:
  Type(std::string name, const Type* base, std::string doc);

  const std::string& name() const { return name_; }
  const std::string& doc() const { return doc_; }
  const Type* base() const { return base_; }
  bool is(const Type& ancestor) const;

  std::span<const Field* const> fields() const { return fields_; }
  const Field& field(int index) const { return *fields_[static_cast<std::size_t>(index)]; }
  /// Index of a field by name, -1 when there is none.
  int find(std::string_view name) const;
  /// Index of this very declaration (inherited ones too), -1 when there is none.
  int find(const Field& field) const;
  /// ", did you mean X?" for a field name that is not there.
  std::string hint(std::string_view name) const;

 private:
  friend class Schema;

  std::string name_, doc_;
  const Type* base_;
  void add(const Field& field);

  std::vector<const Field*> fields_;
  std::vector<std::uint64_t> keys_;  // first bytes and length of each field's name: most others are told apart by them
};

/// All types of a world, in order of declaration.
class Schema {
 public:
  /// With the built-in types.
  Schema();
  Schema(const Schema&) = delete;
  Schema& operator=(const Schema&) = delete;

  const Type* find(std::string_view name) const;
  std::span<const std::unique_ptr<Type>> types() const { return types_; }
  /// How many of them are built in: they stand first.
  std::size_t built_in() const { return built_in_; }
  bool is_built_in(const Type& type) const;

  /// `type NAME [extends BASE] ["doc"]`. Saying the same again changes nothing; saying something else of a known
  /// type is error exists. Returns the type.
  Result<const Type*> declare_type(Words words);

  /// `field TYPE.NAME KIND ...` (see Field). A repeated declaration must be the same: its doc alone may differ. Returns
  /// the field and whether it is new, in which case every object of the type lacks a slot for it
  /// (Database::declare_field adds them).
  struct Declared {
    const Field* field;
    bool fresh;
  };
  Result<Declared> declare_field(Words words);

  /// "TYPE.FIELD" to its field. Errors: syntax, unknown.
  Result<const Field*> field(const Word& word) const;
  Result<const Type*> type(const Word& word) const;

  /// 64 bits over every declaration: equal schemas, equal numbers.
  std::uint64_t hash() const;

 private:
  Type& mutable_type(const Type& type);

  std::vector<std::unique_ptr<Type>> types_;
  std::vector<std::unique_ptr<Field>> fields_;
  tsl::robin_map<std::string, Type*> by_name_;
  std::size_t built_in_ = 0;
};

/// The declarations of the built-in types, one text a file of objdb/types, bases first.
std::span<const std::string_view> built_in_types();

}  // namespace objdb
