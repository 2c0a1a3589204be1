#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "manipulators/render/scene.h"
#include "objdb/database.h"

namespace render {

/// Hexahedra to be shown.
struct ElementMesh {
  std::vector<Eigen::Vector3f> nodes;        ///< where they are now [m], in the figure's frame
  std::vector<Eigen::Vector3f> rest;         ///< where they were at rest; decides what the cut leaves. Same length
  std::vector<std::array<int, 8>> elements;  ///< corners as in Abaqus C3D8: bottom face around, then top face around
  std::vector<float> values;                 ///< one a node or one an element; empty: none
};

/// What is left of the mesh when every element whose centre at rest lies on the negative side of the plane
/// n.p + d = 0 is taken away.
struct CutAway {
  GeometryPointer edges;    ///< lines of the elements at the surface of what is left
  GeometryPointer faces;    ///< the same elements' free faces as triangles
  float low = 0, high = 0;  ///< the values at the two ends of the colours
};

/// Colours run from the least to the greatest value; without values the faces are grey.
CutAway cut_away(const ElementMesh& mesh, const Eigen::Vector4f& plane);

/// Adds the cut-away of every object with the fields `nodes` (real[] or vec3[]) and `elements` (int[], 8 each),
/// coloured by its field `displacement`, `strain` or `error` as the view asks, with a scale at the lower right.
void add_elements(const objdb::Database& world, const objdb::Object& view, Scene& scene);

}  // namespace render
