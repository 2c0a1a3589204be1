#include "manipulators/mesh/read.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <unordered_map>

#include "manipulators/mesh/normals.h"

namespace mesh {
namespace {

/// A surface under construction, in double precision until all transforms are applied.
struct Draft {
  std::vector<Eigen::Vector3d> V;
  std::vector<Eigen::Vector3i> F;
  std::vector<int> part;
  std::vector<std::string> part_names;
};

std::string part_name(const aiMesh& mesh, const aiNode& node) {
  if (mesh.mName.length > 0) {
    return mesh.mName.C_Str();
  }
  return node.mName.length > 0 ? node.mName.C_Str() : "surface";
}

int part_number(Draft& draft, const std::string& name) {
  for (std::size_t i = 0; i < draft.part_names.size(); ++i) {
    if (draft.part_names[i] == name) {
      return static_cast<int>(i);
    }
  }
  draft.part_names.push_back(name);
  return static_cast<int>(draft.part_names.size()) - 1;
}

void add_mesh(const aiMesh& mesh, const aiMatrix4x4& to_world, int part, Draft& draft) {
  const int first = static_cast<int>(draft.V.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D p = to_world * mesh.mVertices[v];
    draft.V.emplace_back(p.x, p.y, p.z);
  }
  // a mirroring transform turns every face inside out
  const bool mirrored = aiMatrix3x3(to_world).Determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices == 3) {
      Eigen::Vector3i corners(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
      if (mirrored) {
        std::swap(corners[1], corners[2]);
      }
      draft.F.push_back(corners.array() + first);
      draft.part.push_back(part);
    }
  }
}

void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Draft& draft) {
  const aiMatrix4x4 to_world = above * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    add_mesh(mesh, to_world, part_number(draft, part_name(mesh, node)), draft);
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    add_node(scene, *node.mChildren[c], to_world, draft);
  }
}

struct CellHash {
  std::size_t operator()(const std::array<std::int64_t, 3>& cell) const {
    std::size_t hash = 0;
    for (std::int64_t coordinate : cell) {
      hash = (hash ^ static_cast<std::size_t>(coordinate)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// For each position the number of the first one within `distance`; a grid of that cell size finds it.
std::vector<int> merged(const std::vector<Eigen::Vector3d>& V, double distance, std::vector<int>& kept) {
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<int>, CellHash> grid;
  std::vector<int> number(V.size());
  const auto find = [&](int v, const std::array<std::int64_t, 3>& cell) {
    for (std::int64_t n = 0; n < 27; ++n) {
      const auto found = grid.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (found == grid.end()) {
        continue;
      }
      for (int other : found->second) {
        if ((V[kept[other]] - V[v]).norm() <= distance) {
          return other;
        }
      }
    }
    return -1;
  };
  for (int v = 0; v < static_cast<int>(V.size()); ++v) {
    std::array<std::int64_t, 3> cell;
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = static_cast<std::int64_t>(std::floor(V[v][axis] / distance));
    }
    number[v] = find(v, cell);
    if (number[v] < 0) {
      number[v] = static_cast<int>(kept.size());
      kept.push_back(v);
      grid[cell].push_back(number[v]);
    }
  }
  return number;
}

void weld(double distance, Draft& draft) {
  std::vector<int> kept;
  const std::vector<int> number = merged(draft.V, distance, kept);
  std::vector<Eigen::Vector3d> V;
  for (int v : kept) {
    V.push_back(draft.V[v]);
  }
  draft.V = std::move(V);
  for (Eigen::Vector3i& face : draft.F) {
    face = {number[face[0]], number[face[1]], number[face[2]]};
  }
}

void drop_degenerate(Draft& draft) {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < draft.F.size(); ++f) {
    const Eigen::Vector3i& face = draft.F[f];
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) {
      draft.F[kept] = face;
      draft.part[kept++] = draft.part[f];
    }
  }
  draft.F.resize(kept);
  draft.part.resize(kept);
}

Surface finished(const Draft& draft) {
  Surface surface;
  surface.V.resize(draft.V.size(), 3);
  for (std::size_t v = 0; v < draft.V.size(); ++v) {
    surface.V.row(v) = draft.V[v].cast<float>();
  }
  surface.F.resize(draft.F.size(), 3);
  for (std::size_t f = 0; f < draft.F.size(); ++f) {
    surface.F.row(f) = draft.F[f];
  }
  surface.part = draft.part;
  surface.part_names = draft.part_names;
  // vertices that no face uses would only disturb bounds and weights
  surface = subset(surface, std::vector<bool>(surface.F.rows(), true));
  surface.N = vertex_normals(surface.V, surface.F);
  return surface;
}

/// A face without corners or with one that does not exist, which Assimp's own steps would abort on.
bool has_broken_face(const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      const auto exists = [&](unsigned v) { return v < mesh.mNumVertices; };
      if (face.mNumIndices == 0 || !std::all_of(face.mIndices, face.mIndices + face.mNumIndices, exists)) {
        return true;
      }
    }
  }
  return false;
}

/// Reads and triangulates; null with `reason` when the file is no good.
const aiScene* read_scene(Assimp::Importer& importer, const std::string& path, std::string& reason) {
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                          aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                          aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                                          aiComponent_LIGHTS | aiComponent_CAMERAS);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene != nullptr && (scene->mRootNode == nullptr || scene->mNumMeshes == 0)) {
    reason = "it holds no mesh";
    return nullptr;
  }
  if (scene != nullptr && has_broken_face(*scene)) {
    reason = "a face has no corners, or one that does not exist";
    return nullptr;
  }
  if (scene != nullptr) {
    scene = importer.ApplyPostProcessing(aiProcess_ValidateDataStructure);
  }
  if (scene != nullptr) {
    scene = importer.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_SortByPType);
  }
  reason = importer.GetErrorString();
  return scene != nullptr && scene->mRootNode != nullptr ? scene : nullptr;
}

/// Whether a PLY file has the end of its header; Assimp 5.2 never comes back from one that has not.
bool is_cut_off_ply(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".ply") {
    return false;
  }
  std::ifstream file(path, std::ios::binary);
  constexpr int longest_header = 1000;
  std::string line;
  for (int i = 0; i < longest_header && std::getline(file, line); ++i) {
    if (line.rfind("end_header", 0) == 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

Result<Surface> read_surface(const std::string& path, const ReadOptions& options) {
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (!std::filesystem::exists(status)) {
    return Error{"io", "mesh file " + path + " does not exist"};
  }
  if (!std::filesystem::is_regular_file(status)) {
    return Error{"io", "mesh file " + path + " is not a file"};
  }
  if (is_cut_off_ply(path)) {
    return Error{"syntax", "mesh file " + path + " cannot be read: its PLY header has no end_header"};
  }

  Assimp::Importer importer;
  std::string reason;
  const aiScene* scene = read_scene(importer, path, reason);
  if (scene == nullptr) {
    return Error{"syntax", "mesh file " + path + " cannot be read: " + reason};
  }

  Draft draft;
  add_node(*scene, *scene->mRootNode, aiMatrix4x4(), draft);
  for (std::size_t v = 0; v < draft.V.size(); ++v) {
    if (!draft.V[v].allFinite() || draft.V[v].cwiseAbs().maxCoeff() > 1e9) {
      return Error{"range", "mesh file " + path + ": vertex " + std::to_string(v + 1) +
                                " is not a finite position within 1e9 m"};
    }
  }
  if (options.weld > 0) {
    weld(options.weld, draft);
  }
  drop_degenerate(draft);
  if (draft.F.empty()) {
    return Error{"range", "mesh file " + path + " has no faces"};
  }
  return finished(draft);
}

}  // namespace mesh
