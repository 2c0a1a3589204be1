#pragma once

#include <string>

namespace face {

/// What `--compare` measures.
struct CompareRequest {
  std::string head;         ///< a head whose expressions are known: OBJ, vertices as the file has them
  std::string expressions;  ///< CSV `expression,vertex,dx,dy,dz`, moved vertices only, in the head's unit
  double unit = 0.01;       ///< metres of the head's unit
  int columns = 32, rows = 32, layers = 3;
};

/// Builds a face on the head, makes each of its expressions with action units and prints how far the motion agrees
/// with the known one: mean direction, place and size of the peak, extent, travel of the mouth's corner. The exit
/// status: 1 and a sentence on standard error for bad data.
int run_compare(const CompareRequest& request);

}  // namespace face
