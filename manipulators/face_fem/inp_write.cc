#include <algorithm>

#include "manipulators/face_fem/inp_file.h"
#include "manipulators/face_fem/text_file.h"

namespace face {
namespace {

constexpr int digits = 11;  // "-1.23456789012e-03" stays below the 20 characters that CalculiX reads

std::string type_of(Element element) {
  switch (element) {
    case Element::hex8:
    case Element::bbar: return "C3D8";
    case Element::wt: return "C3D8I";
    case Element::hex20: return "C3D20";
    case Element::hex20r: return "C3D20R";
  }
  return "";
}

/// names of sets may hold letters, digits, _ and - only
std::string word(const std::string& name, const std::string& fallback) {
  std::string clean;
  for (char c : name) clean += (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ? c : '_';
  return clean.empty() ? fallback : clean;
}

/// members of a set, eight a line
void list(TextFile& file, const std::vector<int>& labels) {
  for (std::size_t k = 0; k < labels.size(); ++k)
    file.add(labels[k]).add(k % 8 == 7 || k + 1 == labels.size() ? "\n" : ", ");
}

void elements(TextFile& file, const Model& model, int material) {
  bool first = true;
  const int count = nodes_of(model.element);
  for (int e = 0; e < int(model.hexahedra.size()); ++e) {
    const Hexahedron& h = model.hexahedra[e];
    if (h.material != material) continue;
    if (first)
      file.add("*ELEMENT, TYPE=").add(type_of(model.element)).add(", ELSET=MATERIAL_").add(material + 1).add("\n");
    first = false;
    file.add(model.label_of_hexahedron(e));
    // the sixteenth word of a line is its last in the format
    for (int a = 0; a < count; ++a) file.add(a == 15 ? ",\n" : ", ").add(model.label_of_node(h.node[a]));
    file.add("\n");
  }
  if (first) return;
  const Material& m = model.materials[material];
  const std::string name = word(m.name, "tissue");
  file.add("*MATERIAL, NAME=").add(name).add("\n*ELASTIC\n").add(m.young, digits).add(", ").add(m.poisson, digits);
  if (m.density > 0) file.add("\n*DENSITY\n").add(m.density, digits);
  file.add("\n*SOLID SECTION, ELSET=MATERIAL_").add(material + 1).add(", MATERIAL=").add(name).add("\n");
}

void sets(TextFile& file, const Model& model) {
  for (int layer = 0; layer < int(model.layers.size()); ++layer) {
    std::vector<int> labels;
    for (int e = 0; e < int(model.hexahedra.size()); ++e)
      if (model.hexahedra[e].layer == layer) labels.push_back(model.label_of_hexahedron(e));
    if (labels.empty()) continue;
    file.add("*ELSET, ELSET=LAYER_").add(word(model.layers[layer], "LAYER")).add("\n");
    list(file, labels);
  }
  std::vector<int> every(model.nodes.size());
  for (int n = 0; n < int(every.size()); ++n) every[n] = model.label_of_node(n);
  file.add("*NSET, NSET=ALL_NODES\n");
  list(file, every);
  for (int bone = 0; bone < int(model.bones.size()); ++bone) {
    std::vector<int> labels;
    for (const Support& s : model.supports)
      if (s.bone == bone) labels.push_back(model.label_of_node(s.node));
    if (labels.empty()) continue;
    file.add("*NSET, NSET=BONE_").add(word(model.bones[bone], "BONE")).add("\n");
    list(file, labels);
  }
}

}  // namespace

Status write_inp(const std::string& path, const Model& model, const Field& load) {
  TextFile file;
  file.add("*HEADING\nsoft tissue between bone and skin; metres, newtons, pascals\n*NODE\n");
  for (int n = 0; n < int(model.nodes.size()); ++n) {
    file.add(model.label_of_node(n));
    for (int i = 0; i < 3; ++i) file.add(", ").add(model.nodes[n][i], digits);
    file.add("\n");
  }
  for (int material = 0; material < int(model.materials.size()); ++material) elements(file, model, material);
  sets(file, model);
  file.add("*STEP\n*STATIC\n*BOUNDARY\n");
  for (const Support& s : model.supports)
    for (int i = 0; i < 3; ++i)
      if (s.held[i])
        file.add(model.label_of_node(s.node))
            .add(", ")
            .add(i + 1)
            .add(", ")
            .add(i + 1)
            .add(", ")
            .add(s.shift[i], digits)
            .add("\n");
  bool loaded = false;
  for (int n = 0; n < int(load.cols()); ++n)
    for (int i = 0; i < 3; ++i) {
      if (load(i, n) == 0) continue;
      if (!loaded) file.add("*CLOAD\n");
      loaded = true;
      file.add(model.label_of_node(n)).add(", ").add(i + 1).add(", ").add(load(i, n), digits).add("\n");
    }
  file.add("*NODE PRINT, NSET=ALL_NODES\nU\n*END STEP\n");
  return file.write(path);
}

}  // namespace face
