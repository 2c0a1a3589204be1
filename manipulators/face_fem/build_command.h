#pragma once

#include <string>
#include <vector>

#include "manipulators/face_fem/face.h"

namespace face {

/// What `face_fem --build` is asked.
struct BuildRequest {
  std::string head;                    ///< OBJ, PLY, STL, Collada, glTF, or a range scan (.vtk)
  double unit = 1;                     ///< metres in one unit of the file
  std::string resolution;              ///< "N" or "COLUMNSxROWS" or "COLUMNSxROWSxLAYERS"; empty: the default
  std::vector<std::string> landmarks;  ///< "NAME=x,y,z", metres
  std::vector<std::string> muscles;    ///< "NAME=AMOUNT"; without left_ or right_ both sides
  double jaw = 0;                      ///< opening, degrees
  bool nonlinear = false;
  std::string scan, write, vtu, surface;  ///< files to write; empty: none
  bool list = false;                      ///< print landmarks and muscles
};

/// Builds, and writes or moves what is asked. Returns the exit status: 0, or 1 after one line of error.
int run_build(const BuildRequest& request);

}  // namespace face
