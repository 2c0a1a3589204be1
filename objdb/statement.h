#pragma once

#include <string>
#include <string_view>

#include "objdb/database.h"

/// The lines that make and change a world: said by people, scripts, files and programs, and told to every mirror.
namespace objdb {

/// Paths of a script that is read `under` a place are relative to it.
struct Scope {
  std::string prefix;  ///< "" or "sailor/"

  /// A path or pattern as the database knows it.
  std::string resolve(std::string_view path) const { return prefix + std::string(path); }
};

/// Names within a scope: a reference is looked up below the prefix first, then from the top.
class ScopedNames : public Names {
 public:
  ScopedNames(const Database& database, const Scope& scope) : database_(database), scope_(scope) {}
  Result<ObjectId> object(const Word& word, const Type* type) const override;
  std::string_view path(ObjectId id) const override { return database_.path(id); }

 private:
  const Database& database_;
  const Scope& scope_;
};

/// Who asks may be refused: a program writes only what it declared and nobody else owns, and makes and deletes objects
/// of its own types only.
class Gate {
 public:
  virtual ~Gate() = default;
  virtual Status may_write(const Object& object, int field) = 0;
  virtual Status may_make(const Object& object) = 0;
};

/// "PATTERN", "PATTERN.FIELD", "PATH.FIELD[3]", "PATH.FIELD[0..9]".
struct Target {
  std::string_view pattern;
  std::string_view field;  ///< empty: all; may hold '*'
  bool sliced = false;
  std::size_t first = 0, last = 0;  ///< elements, both included
  int column = 0;
  int field_column = 0;
};
Result<Target> parse_target(const Word& word);

/// The object at a path. Errors: syntax, unknown.
Result<const Object*> find_object(const Database& database, const Word& word, const Scope& scope);
/// The object that a target names.
inline Result<const Object*> find_object(const Database& database, const Target& target, const Scope& scope) {
  return find_object(database, Word{target.pattern, target.column, false}, scope);
}
/// The field of an object, as an index. Error unknown with a hint.
Result<int> find_field(const Object& object, std::string_view field, int column);
/// Every object that fits a pattern, in order of creation. A pattern without a match is error unknown.
Result<std::vector<const Object*>> find_objects(const Database& database, std::string_view pattern, int column,
                                                const Scope& scope);

/// The words after the verb of: `create TYPE PATH {FIELD VALUE...}`.
Result<ObjectId> create_statement(Database& database, Words words, const Scope& scope);
/// The words after the verb of: `set PATTERN.FIELD VALUE...`, also of one element `[17]` or a run of them `[0..9]`.
Status set_statement(Database& database, Words words, const Scope& scope, Gate* gate = nullptr);
/// Asks memory for what the first lines of `text` will set, all at once, so that each of them does not wait for it in
/// its turn. Does nothing in a world that is small enough to be in the cache anyway.
void look_ahead(const Database& database, std::string_view text);
constexpr int lines_looked_ahead = 16;
/// The words after the verb of: `delete PATTERN [force]`.
Status delete_statement(Database& database, Words words, const Scope& scope);

/// Which fields of an object are told.
using Include = std::function<bool(const Object&, const Field&)>;

/// `create TYPE PATH FIELD VALUE ...` with every field that `include` accepts and that differs from its default, in
/// several lines when one would be too long; references and long arrays are left to append_later_sets.
void append_create(std::string& out, const Database& database, const Object& object, const Include& include);
/// `set PATH.FIELD VALUE ...` lines of what append_create left out, one object's.
void append_later_sets(std::string& out, const Database& database, const Object& object, const Include& include);
/// All lines that make `objects` where none of them is: creations in the given order (parents first), then long arrays
/// and references, node.parent from the top of the tree of frames down, so that no step closes a circle.
void append_objects(std::string& out, const Database& database, std::span<const Object* const> objects,
                    const Include& include);
/// `set PATH.FIELD VALUE...`, in several lines when one would be too long.
void append_set(std::string& out, const Database& database, const Object& object, int field);
/// The same of a value that the object need not have any more.
void append_set(std::string& out, const Names& names, std::string_view path, const Field& field, const Value& value);

/// The whole world as a script: types, fields, objects, references. Reading it gives the same hash.
std::string save(const Database& database);

}  // namespace objdb
