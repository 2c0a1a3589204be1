#include "manipulators/render/look.h"

#include <bit>
#include <type_traits>

namespace render {

using objdb::Object;
using objdb::Value;

const Value* value_of(const Object& object, std::string_view field) {
  const int index = object.type->find(field);
  return index < 0 || static_cast<std::size_t>(index) >= object.slots.size() ? nullptr : &object.value(index);
}

namespace {

template <class T>
const T* held(const Object& object, std::string_view field) {
  const Value* value = value_of(object, field);
  return value ? std::get_if<T>(value) : nullptr;
}

}  // namespace

double real_of(const Object& object, std::string_view field, double otherwise) {
  const auto* value = held<double>(object, field);
  return value ? *value : otherwise;
}

bool flag_of(const Object& object, std::string_view field, bool otherwise) {
  const auto* value = held<std::int64_t>(object, field);
  return value ? *value != 0 : otherwise;
}

std::int64_t integer_of(const Object& object, std::string_view field, std::int64_t otherwise) {
  const auto* value = held<std::int64_t>(object, field);
  return value ? *value : otherwise;
}

Eigen::Vector3f vector_of(const Object& object, std::string_view field, const Eigen::Vector3f& otherwise) {
  const auto* value = held<objdb::Vec3>(object, field);
  return value ? Eigen::Vector3d((*value)[0], (*value)[1], (*value)[2]).cast<float>() : otherwise;
}

Eigen::Quaterniond turn_of(const Object& object, std::string_view field) {
  const auto* value = held<objdb::Quat>(object, field);
  if (!value) return Eigen::Quaterniond::Identity();
  const Eigen::Quaterniond q((*value)[0], (*value)[1], (*value)[2], (*value)[3]);
  return q.norm() > 1e-9 ? q.normalized() : Eigen::Quaterniond::Identity();
}

std::string text_of(const Object& object, std::string_view field, std::string_view otherwise) {
  const auto* value = held<std::string>(object, field);
  return value ? *value : std::string(otherwise);
}

std::string_view word_of(const Object& object, std::string_view field, std::string_view otherwise) {
  const auto* value = held<std::int64_t>(object, field);
  if (!value) return otherwise;
  const auto& words = object.type->field(object.type->find(field)).words;
  return *value >= 0 && static_cast<std::size_t>(*value) < words.size() ? words[static_cast<std::size_t>(*value)]
                                                                        : otherwise;
}

const Object* object_of(const objdb::Database& world, const Object& object, std::string_view field) {
  const auto* value = held<std::int64_t>(object, field);
  return value ? world.object(static_cast<objdb::ObjectId>(*value)) : nullptr;
}

std::vector<const Object*> objects_of(const objdb::Database& world, const Object& object, std::string_view field) {
  std::vector<const Object*> found;
  const auto* value = held<std::vector<std::int64_t>>(object, field);
  if (!value) return found;
  for (std::int64_t id : *value) {
    if (const Object* one = world.object(static_cast<objdb::ObjectId>(id))) found.push_back(one);
  }
  return found;
}

const objdb::Numbers* numbers_of(const Object& object, std::string_view field) {
  return held<objdb::Numbers>(object, field);
}

std::vector<const Object*> all_of(const objdb::Database& world, std::string_view type) {
  const objdb::Type* found = world.schema().find(type);
  return found ? world.objects_of(*found) : std::vector<const Object*>();
}

bool is_a(const objdb::Database& world, const Object& object, std::string_view type) {
  const objdb::Type* found = world.schema().find(type);
  return found && object.type->is(*found);
}

Eigen::Isometry3d frame_of(const objdb::Database& world, const Object& node) {
  Eigen::Isometry3d X_W = Eigen::Isometry3d::Identity();
  if (!node.place) return X_W;
  const objdb::scene::Transform& x = world.scene().world(node);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) X_W.linear()(r, c) = x.R[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
    X_W.translation()[r] = x.p[static_cast<std::size_t>(r)];
  }
  return X_W;
}

std::uint64_t hash_of(const Object& object, std::initializer_list<std::string_view> fields) {
  std::uint64_t hash = object.id;
  auto mix_number = [&](double number) { hash = objdb::hash_word(hash, std::bit_cast<std::uint64_t>(number)); };
  auto mix = [&](const auto& value) {
    using T = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<T, std::string>) {
      hash = objdb::hash_text(value, hash);
    } else if constexpr (std::is_same_v<T, double>) {
      mix_number(value);
    } else if constexpr (std::is_same_v<T, std::int64_t>) {
      hash = objdb::hash_word(hash, static_cast<std::uint64_t>(value));
    } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      for (const std::string& text : value) hash = objdb::hash_text(text, hash);
    } else if constexpr (std::is_same_v<T, std::vector<std::int64_t>>) {
      for (std::int64_t number : value) hash = objdb::hash_word(hash, static_cast<std::uint64_t>(number));
    } else if constexpr (std::is_same_v<T, objdb::Numbers>) {
      hash = objdb::hash_word(hash, value.hash());
    } else {
      for (double number : value) mix_number(number);
    }
  };
  for (std::string_view field : fields) {
    if (const Value* value = value_of(object, field)) std::visit(mix, *value);
  }
  return hash;
}

}  // namespace render
