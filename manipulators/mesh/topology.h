#pragma once

#include <vector>

#include "manipulators/mesh/surface.h"

namespace mesh {

/// Connected components over shared vertices: for each face the number of its component, numbered by first face.
std::vector<int> components(const Surface& surface);

/// What a surface is made of, as needed before it is trusted to bound a solid.
struct Topology {
  int components = 0;
  int boundary_edges = 0;     ///< edges with one face
  int nonmanifold_edges = 0;  ///< edges with more than two faces
  int misoriented_edges = 0;  ///< edges whose two faces run along them in the same direction
  int unused_vertices = 0;    ///< vertices of no face
  int euler = 0;              ///< used vertices - edges + faces: 2 per closed sphere-like component
  double area = 0;            ///< square metres
  double volume = 0;          ///< signed, cubic metres; positive when closed and outward; divergence theorem

  bool closed() const { return boundary_edges == 0; }
  bool manifold() const { return nonmanifold_edges == 0 && misoriented_edges == 0; }
};

/// Counts the features of `surface`. Cost: one sort of the edges.
Topology topology(const Surface& surface);

/// The boundary loops, each a list of vertices in the order of the faces' edges; longest first.
std::vector<std::vector<int>> boundary_loops(const Surface& surface);

}  // namespace mesh
