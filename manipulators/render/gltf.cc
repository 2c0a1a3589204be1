#include "manipulators/render/gltf.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>

#include "manipulators/render/look.h"
#include "manipulators/render/stage.h"

namespace render {

namespace {

struct Pose {
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();
  Eigen::Quaternionf rotation = Eigen::Quaternionf::Identity();
  Eigen::Vector3f scale = Eigen::Vector3f::Ones();
};

// placements are made of a turn and a stretch along the geometry's own axes
Pose pose_of(const Eigen::Affine3f& X) {
  Pose pose;
  pose.translation = X.translation();
  Eigen::Matrix3f m = X.linear();
  pose.scale = m.colwise().norm().cwiseMax(1e-9f).transpose();
  if (m.determinant() < 0) pose.scale.x() *= -1;
  for (int c = 0; c < 3; ++c) m.col(c) /= pose.scale[c];
  pose.rotation = Eigen::Quaternionf(m).normalized();
  return pose;
}

std::vector<double> numbers(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }
std::vector<double> numbers(const Eigen::Quaternionf& q) { return {q.x(), q.y(), q.z(), q.w()}; }

}  // namespace

class Gltf::Builder {
 public:
  Builder() {
    model_.asset.version = "2.0";
    model_.asset.generator = "The Virtual Sailor";
    model_.buffers.emplace_back();
    model_.scenes.emplace_back();
    model_.defaultScene = 0;
  }

  void moment(const objdb::Database& world, const Scene& scene, const Skins& skins, double time) {
    std::map<std::string, Pose> now;
    std::map<std::string, int> ordinals;
    for (const Drawable& drawable : scene.drawables) {
      if (drawable.helper || !drawable.geometry || drawable.geometry->primitive != Primitive::triangles) continue;
      if (drawable.geometry->vertices.empty() || drawable.materials.empty()) continue;
      // several drawables may stand for one object: an eye and its lids
      const int ordinal = ordinals[drawable.path]++;
      const std::string name = ordinal == 0 ? drawable.path : drawable.path + "#" + std::to_string(ordinal);
      const objdb::Object* object = world.find(drawable.path);
      const mesh::Skin* skin = object ? skins.bound(object->id) : nullptr;
      if (skin) {
        const std::vector<objdb::ObjectId>& bones = skins.bones(object->id);
        for (objdb::ObjectId bone : bones) {
          const objdb::Object* one = world.object(bone);
          if (one) now[one->path] = pose_of(Eigen::Affine3f(frame_of(world, *one).cast<float>()));
        }
        if (times_.empty()) add_skin(world, name, drawable, *skin, skins.rest(object->id), bones);
      } else {
        now[name] = pose_of(drawable.X_WG);
        if (times_.empty()) add_node(name, add_mesh(drawable, nullptr, nullptr));
      }
    }
    for (const objdb::Object* camera : all_of(world, "camera")) {
      const Camera lens = camera_of(world, *camera);
      // glTF cameras look along -Z
      Eigen::Affine3f X(lens.X_WC);
      X.rotate(Eigen::AngleAxisf(std::numbers::pi_v<float>, Eigen::Vector3f::UnitY()));
      now[camera->path] = pose_of(X);
      if (times_.empty()) add_camera(camera->path, lens);
    }
    times_.push_back(static_cast<float>(time));
    for (auto& [name, track] : tracks_) {
      const auto found = now.find(name);
      track.push_back(found != now.end() ? found->second : track.empty() ? Pose() : track.back());
    }
  }

  int moments() const { return static_cast<int>(times_.size()); }

  std::string write(const std::string& path) const {
    if (times_.empty()) return "there is no moment to write";
    tinygltf::Model model = model_;
    for (const auto& [name, track] : tracks_) {
      tinygltf::Node& node = model.nodes[static_cast<std::size_t>(nodes_.at(name))];
      node.translation = numbers(track[0].translation);
      node.rotation = numbers(track[0].rotation);
      node.scale = numbers(track[0].scale);
    }
    if (times_.size() > 1) animate(model);
    tinygltf::TinyGLTF writer;
    const std::string partial = path + ".part";
    if (!writer.WriteGltfSceneToFile(&model, partial, true, true, false, true)) return "cannot write '" + path + "'";
    std::error_code error;
    std::filesystem::rename(partial, path, error);
    return error ? "cannot write '" + path + "': " + error.message() : std::string();
  }

 private:
  // appends an array to the one buffer and describes it; returns the accessor's number
  template <typename T>
  static int add_array(tinygltf::Model& model, const std::vector<T>& values, int type, int component, int target,
                       std::size_t per_element) {
    std::vector<unsigned char>& data = model.buffers[0].data;
    while (data.size() % 4 != 0) data.push_back(0);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    data.resize(data.size() + view.byteLength);
    if (!values.empty()) std::memcpy(data.data() + view.byteOffset, values.data(), view.byteLength);
    model.bufferViews.push_back(view);

    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = values.size() / per_element;
    if constexpr (std::is_same_v<T, float>) {
      // readers want the range of positions and times
      for (std::size_t c = 0; c < per_element && !values.empty() && per_element <= 4; ++c) {
        double low = values[c];
        double high = values[c];
        for (std::size_t i = c; i < values.size(); i += per_element) {
          low = std::min<double>(low, values[i]);
          high = std::max<double>(high, values[i]);
        }
        accessor.minValues.push_back(low);
        accessor.maxValues.push_back(high);
      }
    }
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
  }

  int add_floats(const std::vector<float>& values, int type, std::size_t per_element) {
    return add_array(model_, values, type, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER, per_element);
  }

  int add_material(const Material& material) {
    for (std::size_t i = 0; i < materials_.size(); ++i) {
      if (materials_[i] == material) return static_cast<int>(i);
    }
    const Eigen::Vector3f linear = linear_of(material.color);
    tinygltf::Material out;
    out.pbrMetallicRoughness.baseColorFactor = {linear.x(), linear.y(), linear.z(), material.opacity};
    out.pbrMetallicRoughness.metallicFactor = 0;
    out.pbrMetallicRoughness.roughnessFactor = material.roughness;
    if (material.opacity < 0.995f) out.alphaMode = "BLEND";
    out.doubleSided = true;
    model_.materials.push_back(out);
    materials_.push_back(material);
    return static_cast<int>(materials_.size()) - 1;
  }

  // a skin's mesh is at `rest`, in its bind pose, with joints and weights
  int add_mesh(const Drawable& drawable, const mesh::Skin* skin, const Eigen::MatrixX3f* rest) {
    const Geometry& geometry = *drawable.geometry;
    const std::size_t count = geometry.vertices.size();
    Eigen::MatrixX3f N;
    if (skin) mesh::vertex_normals(*rest, skin->surface.F, skin->weld, N);
    std::vector<float> positions, normals;
    positions.reserve(3 * count);
    normals.reserve(3 * count);
    for (std::size_t v = 0; v < count; ++v) {
      const auto row = static_cast<Eigen::Index>(v);
      const Eigen::Vector3f p = skin ? Eigen::Vector3f(rest->row(row)) : geometry.vertices[v].position;
      Eigen::Vector3f n = skin ? Eigen::Vector3f(N.row(row)) : geometry.vertices[v].normal;
      n = n.norm() > 1e-6f ? n.normalized() : Eigen::Vector3f::UnitY();
      positions.insert(positions.end(), {p.x(), p.y(), p.z()});
      normals.insert(normals.end(), {n.x(), n.y(), n.z()});
    }
    tinygltf::Primitive common;
    common.mode = TINYGLTF_MODE_TRIANGLES;
    common.attributes["POSITION"] = add_floats(positions, TINYGLTF_TYPE_VEC3, 3);
    common.attributes["NORMAL"] = add_floats(normals, TINYGLTF_TYPE_VEC3, 3);
    if (skin) {
      std::vector<std::uint16_t> joints;
      std::vector<float> weights;
      for (std::size_t v = 0; v < count; ++v) {
        const auto row = static_cast<Eigen::Index>(v);
        const float sum = std::max(skin->weight.row(row).head<4>().sum(), 1e-9f);
        for (int k = 0; k < 4; ++k) {
          const float weight = skin->weight(row, k) / sum;
          joints.push_back(weight > 0 ? static_cast<std::uint16_t>(skin->index(row, k)) : 0);
          weights.push_back(weight);
        }
      }
      common.attributes["JOINTS_0"] = add_array(
          model_, joints, TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TARGET_ARRAY_BUFFER, 4);
      common.attributes["WEIGHTS_0"] = add_floats(weights, TINYGLTF_TYPE_VEC4, 4);
    }
    tinygltf::Mesh out;
    out.name = drawable.path;
    const Level& level = geometry.levels[0];
    for (const Span& span : level.spans) {
      const auto which =
          std::min<std::size_t>(static_cast<std::size_t>(std::max(span.material, 0)), drawable.materials.size() - 1);
      if (span.count == 0 || drawable.materials[which].opacity <= 0) continue;
      tinygltf::Primitive primitive = common;
      const std::vector<std::uint32_t> indices(level.indices.begin() + span.first,
                                               level.indices.begin() + span.first + span.count);
      primitive.indices = add_array(model_, indices, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                    TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, 1);
      primitive.material = add_material(drawable.materials[which]);
      out.primitives.push_back(primitive);
    }
    model_.meshes.push_back(out);
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  // a node at the top of the scene whose movement is followed
  int add_node(const std::string& name, int mesh) {
    tinygltf::Node node;
    node.name = name;
    node.mesh = mesh;
    model_.nodes.push_back(node);
    const int number = static_cast<int>(model_.nodes.size()) - 1;
    model_.scenes[0].nodes.push_back(number);
    nodes_[name] = number;
    tracks_[name];
    return number;
  }

  void add_skin(const objdb::Database& world, const std::string& name, const Drawable& drawable, const mesh::Skin& skin,
                const Eigen::MatrixX3f& rest, const std::vector<objdb::ObjectId>& bones) {
    tinygltf::Skin out;
    out.name = name;
    std::vector<float> inverses;
    for (std::size_t b = 0; b < bones.size(); ++b) {
      const std::string path = world.object(bones[b])->path;
      const auto known = nodes_.find(path);
      out.joints.push_back(known != nodes_.end() ? known->second : add_node(path, -1));
      const Eigen::Matrix4f inverse = skin.bones[b].bind.inverse().matrix().cast<float>();
      inverses.insert(inverses.end(), inverse.data(), inverse.data() + 16);
    }
    out.inverseBindMatrices = add_array(model_, inverses, TINYGLTF_TYPE_MAT4, TINYGLTF_COMPONENT_TYPE_FLOAT, 0, 16);
    model_.skins.push_back(out);
    // a skinned mesh is placed by its bones alone
    tinygltf::Node node;
    node.name = name;
    node.mesh = add_mesh(drawable, &skin, &rest);
    node.skin = static_cast<int>(model_.skins.size()) - 1;
    model_.nodes.push_back(node);
    model_.scenes[0].nodes.push_back(static_cast<int>(model_.nodes.size()) - 1);
  }

  void add_camera(const std::string& name, const Camera& lens) {
    tinygltf::Camera camera;
    camera.name = name;
    camera.type = "perspective";
    camera.perspective.yfov = lens.field_of_view;
    camera.perspective.znear = lens.near;
    camera.perspective.zfar = lens.far;
    camera.perspective.aspectRatio = 16.0 / 9;
    model_.cameras.push_back(camera);
    model_.nodes[static_cast<std::size_t>(add_node(name, -1))].camera = static_cast<int>(model_.cameras.size()) - 1;
  }

  void animate(tinygltf::Model& model) const {
    tinygltf::Animation animation;
    animation.name = "movement";
    std::vector<float> times;
    for (float time : times_) times.push_back(time - times_[0]);
    const int input = add_array(model, times, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT, 0, 1);
    auto add_channel = [&](int node, const char* path, const std::vector<float>& values, int type, std::size_t size) {
      tinygltf::AnimationSampler sampler;
      sampler.input = input;
      sampler.output = add_array(model, values, type, TINYGLTF_COMPONENT_TYPE_FLOAT, 0, size);
      sampler.interpolation = "LINEAR";
      animation.samplers.push_back(sampler);
      tinygltf::AnimationChannel channel;
      channel.sampler = static_cast<int>(animation.samplers.size()) - 1;
      channel.target_node = node;
      channel.target_path = path;
      animation.channels.push_back(channel);
    };
    for (const auto& [name, track] : tracks_) {
      std::vector<float> places, turns;
      bool moves = false;
      bool turns_at_all = false;
      for (const Pose& pose : track) {
        moves = moves || pose.translation != track[0].translation;
        turns_at_all = turns_at_all || pose.rotation.coeffs() != track[0].rotation.coeffs();
        places.insert(places.end(), {pose.translation.x(), pose.translation.y(), pose.translation.z()});
        // neighbouring quaternions on the same side, so that readers take the short way
        Eigen::Vector4f q = pose.rotation.coeffs();
        const std::size_t last = turns.size();
        if (last >= 4 &&
            q.dot(Eigen::Vector4f(turns[last - 4], turns[last - 3], turns[last - 2], turns[last - 1])) < 0) {
          q = -q;
        }
        turns.insert(turns.end(), {q.x(), q.y(), q.z(), q.w()});
      }
      const int node = nodes_.at(name);
      if (moves) add_channel(node, "translation", places, TINYGLTF_TYPE_VEC3, 3);
      if (turns_at_all) add_channel(node, "rotation", turns, TINYGLTF_TYPE_VEC4, 4);
    }
    if (!animation.channels.empty()) model.animations.push_back(animation);
  }

  tinygltf::Model model_;
  std::vector<Material> materials_;
  std::map<std::string, int> nodes_;
  std::map<std::string, std::vector<Pose>> tracks_;
  std::vector<float> times_;
};

Gltf::Gltf() : builder_(std::make_unique<Builder>()) {}
Gltf::~Gltf() = default;
void Gltf::moment(const objdb::Database& world, const Scene& scene, const Skins& skins, double time) {
  builder_->moment(world, scene, skins, time);
}
int Gltf::moments() const { return builder_->moments(); }
std::string Gltf::write(const std::string& path) const { return builder_->write(path); }

}  // namespace render
