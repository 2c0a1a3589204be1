#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "objdb/database.h"

/// Looks at an object's fields by name that do not mind whether the field is there: the types that are drawn come
/// from several programs, and each may be younger or older than this one.
namespace render {

/// The stored value, null when the object has no such field.
const objdb::Value* value_of(const objdb::Object& object, std::string_view field);

double real_of(const objdb::Object& object, std::string_view field, double otherwise = 0);
bool flag_of(const objdb::Object& object, std::string_view field, bool otherwise = false);
std::int64_t integer_of(const objdb::Object& object, std::string_view field, std::int64_t otherwise = 0);
Eigen::Vector3f vector_of(const objdb::Object& object, std::string_view field,
                          const Eigen::Vector3f& otherwise = Eigen::Vector3f::Zero());
Eigen::Quaterniond turn_of(const objdb::Object& object, std::string_view field);
std::string text_of(const objdb::Object& object, std::string_view field, std::string_view otherwise = {});
/// The word of a word field; empty when there is none.
std::string_view word_of(const objdb::Object& object, std::string_view field, std::string_view otherwise = {});
/// The object referred to, null for none.
const objdb::Object* object_of(const objdb::Database& world, const objdb::Object& object, std::string_view field);
/// All objects of a ref[] field that exist.
std::vector<const objdb::Object*> objects_of(const objdb::Database& world, const objdb::Object& object,
                                             std::string_view field);
/// A flat array of numbers; null when the field is absent or of another shape.
const objdb::Numbers* numbers_of(const objdb::Object& object, std::string_view field);

/// All objects of a type by name and its subtypes, none when the type is unknown.
std::vector<const objdb::Object*> all_of(const objdb::Database& world, std::string_view type);
/// Is the object of that type or a subtype of it?
bool is_a(const objdb::Database& world, const objdb::Object& object, std::string_view type);

/// World frame of a node.
Eigen::Isometry3d frame_of(const objdb::Database& world, const objdb::Object& node);

/// 64 bits over the values of these fields; absent ones do not count.
std::uint64_t hash_of(const objdb::Object& object, std::initializer_list<std::string_view> fields);

}  // namespace render
