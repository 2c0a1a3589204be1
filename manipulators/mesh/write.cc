#include "manipulators/mesh/write.h"

#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Exporter.hpp>
#include <cmath>
#include <filesystem>
#include <memory>

namespace mesh {
namespace {

/// The exporter for a file's ending; null when there is none.
const char* format_of(const std::string& ending) {
  struct Format {
    const char* ending;
    const char* name;
  };
  constexpr Format formats[] = {{".obj", "objnomtl"}, {".ply", "plyb"}, {".stl", "stlb"}, {".glb", "glb2"}};
  for (const Format& format : formats) {
    if (ending == format.ending) {
      return format.name;
    }
  }
  return nullptr;
}

std::string fault(const Surface& surface) {
  if (surface.F.rows() == 0) {
    return "the surface has no faces";
  }
  if (static_cast<Eigen::Index>(surface.part.size()) != surface.F.rows()) {
    return "the surface has " + std::to_string(surface.F.rows()) + " faces and parts for " +
           std::to_string(surface.part.size());
  }
  if (surface.F.minCoeff() < 0 || surface.F.maxCoeff() >= surface.V.rows()) {
    return "a face uses a vertex that does not exist";
  }
  if (!surface.V.allFinite() || !surface.N.allFinite()) {
    return "a vertex is not finite";
  }
  return "";
}

/// One aiMesh per part, with the vertices that it uses. The scene owns all of it.
std::unique_ptr<aiMesh> part_mesh(const Surface& surface, int part) {
  std::vector<bool> keep;
  for (int p : surface.part) {
    keep.push_back(p == part);
  }
  const Surface piece = subset(surface, keep);
  auto result = std::make_unique<aiMesh>();
  result->mName.Set(surface.part_names[part]);
  result->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  result->mNumVertices = static_cast<unsigned>(piece.V.rows());
  result->mVertices = new aiVector3D[result->mNumVertices];
  for (Eigen::Index v = 0; v < piece.V.rows(); ++v) {
    result->mVertices[v] = {piece.V(v, 0), piece.V(v, 1), piece.V(v, 2)};
  }
  if (piece.N.rows() > 0) {
    result->mNormals = new aiVector3D[result->mNumVertices];
    for (Eigen::Index v = 0; v < piece.N.rows(); ++v) {
      result->mNormals[v] = {piece.N(v, 0), piece.N(v, 1), piece.N(v, 2)};
    }
  }
  result->mNumFaces = static_cast<unsigned>(piece.F.rows());
  result->mFaces = new aiFace[result->mNumFaces];
  for (Eigen::Index f = 0; f < piece.F.rows(); ++f) {
    result->mFaces[f].mNumIndices = 3;
    result->mFaces[f].mIndices = new unsigned[3];
    for (int corner = 0; corner < 3; ++corner) {
      result->mFaces[f].mIndices[corner] = static_cast<unsigned>(piece.F(f, corner));
    }
  }
  return result;
}

std::unique_ptr<aiScene> scene_of(const Surface& surface) {
  std::vector<std::unique_ptr<aiMesh>> meshes;
  for (std::size_t part = 0; part < surface.part_names.size(); ++part) {
    if (std::find(surface.part.begin(), surface.part.end(), static_cast<int>(part)) != surface.part.end()) {
      meshes.push_back(part_mesh(surface, static_cast<int>(part)));
    }
  }
  auto scene = std::make_unique<aiScene>();
  scene->mRootNode = new aiNode("surface");
  scene->mNumMaterials = 1;
  scene->mMaterials = new aiMaterial* [1] { new aiMaterial };
  scene->mNumMeshes = static_cast<unsigned>(meshes.size());
  scene->mMeshes = new aiMesh*[meshes.size()];
  // a node per part, so that every format keeps the parts' names
  scene->mRootNode->mNumChildren = scene->mNumMeshes;
  scene->mRootNode->mChildren = new aiNode*[meshes.size()];
  for (unsigned m = 0; m < meshes.size(); ++m) {
    auto* node = new aiNode(meshes[m]->mName.C_Str());
    node->mParent = scene->mRootNode;
    node->mNumMeshes = 1;
    node->mMeshes = new unsigned[1]{m};
    scene->mRootNode->mChildren[m] = node;
    scene->mMeshes[m] = meshes[m].release();
  }
  return scene;
}

}  // namespace

Result<std::size_t> write_surface(const std::string& path, const Surface& surface) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const char* format = format_of(ending);
  if (format == nullptr) {
    return Error{"unknown", "mesh file " + path + ": expected a name ending in .obj, .ply, .stl or .glb"};
  }
  if (const std::string sentence = fault(surface); !sentence.empty()) {
    return Error{"range", "mesh file " + path + ": " + sentence};
  }
  Assimp::Exporter exporter;
  const std::unique_ptr<aiScene> scene = scene_of(surface);
  if (exporter.Export(scene.get(), format, path) != aiReturn_SUCCESS) {
    return Error{"io", "mesh file " + path + " cannot be written: " + exporter.GetErrorString()};
  }
  std::error_code failure;
  const auto size = std::filesystem::file_size(path, failure);
  if (failure) {
    return Error{"io", "mesh file " + path + " cannot be written: " + failure.message()};
  }
  return static_cast<std::size_t>(size);
}

}  // namespace mesh
