#include "manipulators/face_fem/vtu_file.h"

#include "manipulators/face_fem/text_file.h"

namespace face {
namespace {

constexpr int digits = 8;  // ParaView keeps single precision

template <class Matrix>
void array(TextFile& file, const char* name, const Matrix& columns) {
  file.add("<DataArray type=\"Float32\" Name=\"").add(name).add("\" NumberOfComponents=\"");
  file.add(int(columns.rows())).add("\" format=\"ascii\">\n");
  for (int c = 0; c < columns.cols(); ++c)
    for (int r = 0; r < columns.rows(); ++r) file.add(columns(r, c), digits).add(r + 1 == columns.rows() ? "\n" : " ");
  file.add("</DataArray>\n");
}

/// one whole number a cell
template <class Number>
void cells(TextFile& file, const char* name, int count, Number number) {
  file.add("<DataArray type=\"Int32\" Name=\"").add(name).add("\" format=\"ascii\">\n");
  for (int e = 0; e < count; ++e) file.add(int(number(e))).add(e % 20 == 19 || e + 1 == count ? "\n" : " ");
  file.add("</DataArray>\n");
}

}  // namespace

Status write_vtu(const std::string& path, const Model& model, const Field& u,
                 const Eigen::Matrix<double, 6, Eigen::Dynamic>& stress) {
  const int nodes = int(model.nodes.size()), count = int(model.hexahedra.size()), each = nodes_of(model.element);
  Field rest(3, nodes);
  for (int n = 0; n < nodes; ++n) rest.col(n) = model.nodes[n];
  TextFile file;
  file.add("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n")
      .add("<UnstructuredGrid>\n<Piece NumberOfPoints=\"")
      .add(nodes)
      .add("\" NumberOfCells=\"")
      .add(count)
      .add("\">\n<Points>\n");
  array(file, "position", rest);
  file.add("</Points>\n<PointData Vectors=\"displacement\">\n");
  array(file, "displacement", u);
  if (stress.cols() == nodes) array(file, "stress", stress);
  file.add("</PointData>\n<CellData>\n");
  cells(file, "material", count, [&](int e) { return model.hexahedra[e].material; });
  cells(file, "layer", count, [&](int e) { return model.hexahedra[e].layer; });
  file.add("</CellData>\n<Cells>\n");
  // VTK lists the nodes of its hexahedra (12) and quadratic hexahedra (25) in the order of element.h
  cells(file, "connectivity", count * each, [&](int k) { return model.hexahedra[k / each].node[k % each]; });
  cells(file, "offsets", count, [&](int e) { return (e + 1) * each; });
  cells(file, "types", count, [&](int) { return each == 8 ? 12 : 25; });
  file.add("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
  return file.write(path);
}

}  // namespace face
