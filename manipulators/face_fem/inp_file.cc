#include "manipulators/face_fem/inp_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "manipulators/face_fem/load.h"

namespace face {
namespace {

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

/// a word of a line and where it starts
struct Word {
  std::string_view text;
  int column = 1;
};

/// words between commas, without the blanks around them; a comma at the end of a line adds none
std::vector<Word> split(std::string_view line) {
  std::vector<Word> words;
  std::size_t begin = 0;
  while (begin <= line.size()) {
    std::size_t end = std::min(line.find(',', begin), line.size());
    std::size_t first = begin, last = end;
    while (first < last && (line[first] == ' ' || line[first] == '\t')) ++first;
    while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t')) --last;
    if (end < line.size() || last > first) words.push_back({line.substr(first, last - first), int(first) + 1});
    begin = end + 1;
  }
  return words;
}

struct Keyword {
  std::string name;  // "SOLID SECTION"
  std::map<std::string, Word> parameter;
};

/// turns the text into a job, one card (a keyword with its data lines) after the other
class Reader {
 public:
  Reader(const std::string& text, const std::string& name) : text_(text), name_(name) {}

  Result<Job> run() {
    while (next_line())
      if (auto status = line(); !status) return status.error();
    if (auto status = end_card(); !status) return status.error();
    return finish();
  }

 private:
  struct Section {
    std::string elements, material;
    int line;
  };
  struct Loading {
    bool boundary;
    std::vector<int> targets;  // nodes, or elements for distributed loads
    int first, last;
    double value;
    int side;  // 0..5 pressure, -1 concentrated or boundary, -2 gravity
    Eigen::Vector3d direction;
  };

  Error fail(Fault fault, int column, const std::string& sentence) const {
    return {fault, name_ + ":" + std::to_string(line_) + ":" + std::to_string(column) + ": " + sentence};
  }

  bool next_line() {
    if (at_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    current_ = std::string_view(text_).substr(at_, end - at_);
    if (!current_.empty() && current_.back() == '\r') current_.remove_suffix(1);
    at_ = end + 1;
    ++line_;
    return true;
  }

  Status line() {
    if (current_.substr(0, 2) == "**") return success();
    if (current_.find_first_not_of(" \t") == std::string_view::npos) return success();
    if (current_[0] == '*') {
      if (auto status = end_card(); !status) return status;
      return begin_card();
    }
    if (skipping_) return success();
    return data(split(current_));
  }

  Status begin_card() {
    const std::vector<Word> words = split(current_.substr(1));
    Keyword keyword;
    if (words.empty()) return fail(Fault::syntax, 1, "a keyword is expected after *");
    // blanks inside a keyword may be many
    std::istringstream parts{upper(words[0].text)};
    for (std::string part; parts >> part;) keyword.name += (keyword.name.empty() ? "" : " ") + part;
    for (std::size_t k = 1; k < words.size(); ++k) {
      const std::size_t equals = words[k].text.find('=');
      std::string_view key = words[k].text.substr(0, equals);
      while (!key.empty() && key.back() == ' ') key.remove_suffix(1);
      Word value{"", words[k].column + 1};
      if (equals != std::string_view::npos) {
        std::size_t first = equals + 1;
        while (first < words[k].text.size() && words[k].text[first] == ' ') ++first;
        value = {words[k].text.substr(first), words[k].column + 1 + int(first)};
      }
      keyword.parameter[upper(key)] = value;
    }
    keyword_ = keyword;
    card_line_ = line_;
    rows_ = 0;
    skipping_ = false;
    return start();
  }

  std::optional<std::string> parameter(const char* key) const {
    const auto found = keyword_.parameter.find(key);
    if (found == keyword_.parameter.end()) return std::nullopt;
    return upper(found->second.text);
  }

  Result<std::string> needed(const char* key) const {
    const auto value = parameter(key);
    if (!value || value->empty()) return fail(Fault::syntax, 1, "*" + keyword_.name + " needs " + key + "=NAME");
    return *value;
  }

  Status start() {
    const std::string& name = keyword_.name;
    static const char* const skipped[] = {"HEADING",     "NODE PRINT",     "EL PRINT", "NODE FILE", "EL FILE",
                                          "NODE OUTPUT", "ELEMENT OUTPUT", "OUTPUT",   "STATIC",    "PREPRINT"};
    for (const char* word : skipped)
      if (name == word) {
        skipping_ = true;
        return success();
      }
    if (name == "NODE") return start_set(parameter("NSET"), job_.node_sets);
    if (name == "ELEMENT") return start_elements();
    if (name == "NSET" || name == "ELSET") {
      auto set = needed(name.c_str());
      if (!set) return set.error();
      return start_set(*set, name == "NSET" ? job_.node_sets : job_.element_sets);
    }
    if (name == "MATERIAL") {
      auto material = needed("NAME");
      if (!material) return material.error();
      for (const Material& known : job_.model.materials)
        if (known.name == *material) return fail(Fault::syntax, 1, "material " + *material + " is defined twice");
      job_.model.materials.push_back({*material, NAN, NAN, 0});
      return success();
    }
    if (name == "ELASTIC" || name == "DENSITY") {
      if (job_.model.materials.empty()) return fail(Fault::syntax, 1, "*" + name + " must follow *MATERIAL");
      const auto type = parameter("TYPE");
      if (type && *type != "ISO" && *type != "ISOTROPIC")
        return fail(Fault::unknown, keyword_.parameter["TYPE"].column,
                    "*ELASTIC is isotropic here (TYPE=ISO), is " + *type);
      return success();
    }
    if (name == "SOLID SECTION") {
      auto elements = needed("ELSET"), material = needed("MATERIAL");
      if (!elements) return elements.error();
      if (!material) return material.error();
      sections_.push_back({*elements, *material, line_});
      skipping_ = true;
      return success();
    }
    if (name == "STEP") {
      if (job_.has_step || in_step_) return fail(Fault::syntax, 1, "one step is solved, this is a second *STEP");
      const auto large = parameter("NLGEOM");
      if (large && *large != "NO")
        return fail(Fault::unknown, keyword_.parameter["NLGEOM"].column,
                    "the job is linear in the file; leave NLGEOM out and ask for --nonlinear instead");
      in_step_ = true;
      return success();
    }
    if (name == "END STEP") {
      if (!in_step_) return fail(Fault::syntax, 1, "*END STEP without *STEP");
      in_step_ = false;
      job_.has_step = true;
      return success();
    }
    if (name == "BOUNDARY" || name == "CLOAD" || name == "DLOAD") {
      if (name != "BOUNDARY" && !in_step_) return fail(Fault::syntax, 1, "*" + name + " must stand inside *STEP");
      return success();
    }
    return fail(Fault::unknown, 2,
                "keyword *" + name +
                    " is not one of NODE ELEMENT NSET ELSET MATERIAL ELASTIC DENSITY SOLID SECTION BOUNDARY STEP "
                    "STATIC CLOAD DLOAD END STEP HEADING");
  }

  Status start_set(const std::optional<std::string>& name, std::map<std::string, std::vector<int>>& sets) {
    set_ = name ? &sets[*name] : nullptr;
    generate_ = keyword_.parameter.count("GENERATE") > 0;
    return success();
  }

  Status start_elements() {
    auto type = needed("TYPE");
    if (!type) return type.error();
    static const std::map<std::string, Element> kinds = {
        {"C3D8", Element::bbar}, {"C3D8I", Element::wt}, {"C3D20", Element::hex20}, {"C3D20R", Element::hex20r}};
    const auto kind = kinds.find(*type);
    if (kind == kinds.end())
      return fail(Fault::unknown, keyword_.parameter["TYPE"].column,
                  "element type must be C3D8, C3D8I, C3D20 or C3D20R, is " + *type);
    if (!job_.model.hexahedra.empty() && kind->second != job_.model.element)
      return fail(Fault::element, keyword_.parameter["TYPE"].column,
                  "all elements of a model are of one type, this is " + *type + " after another");
    job_.model.element = kind->second;
    return start_set(parameter("ELSET"), job_.element_sets);
  }

  Result<int> integer(const Word& word, const char* what) const {
    int value = 0;
    const char *first = word.text.data(), *last = first + word.text.size();
    if (first != last && *first == '+') ++first;
    const auto [end, problem] = std::from_chars(first, last, value);
    if (problem == std::errc() && end == last && first != last) return value;
    return fail(Fault::syntax, word.column,
                std::string(what) + " must be a whole number, is '" + std::string(word.text) + "'");
  }

  Result<double> real(const Word& word, const char* what) const {
    std::string_view text = word.text;
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    double value = 0;
    auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem == std::errc() && end < text.data() + text.size() && (*end == 'D' || *end == 'd')) {
      // Fortran's exponent
      std::string copy(text);
      std::replace_if(
          copy.begin(), copy.end(), [](char c) { return c == 'D' || c == 'd'; }, 'e');
      const auto again = std::from_chars(copy.data(), copy.data() + copy.size(), value);
      problem = again.ec;
      end = text.data() + (again.ptr - copy.data());
    }
    if (text.empty() || problem == std::errc::invalid_argument || end != text.data() + text.size())
      return fail(Fault::syntax, word.column,
                  std::string(what) + " must be a number, is '" + std::string(word.text) + "'");
    if (problem != std::errc() || !std::isfinite(value))
      return fail(Fault::not_finite, word.column,
                  std::string(what) + " must be finite, is '" + std::string(word.text) + "'");
    return value;
  }

  Status data(const std::vector<Word>& words) {
    ++rows_;
    const std::string& name = keyword_.name;
    if (name == "NODE") return node(words);
    if (name == "ELEMENT") return element(words);
    if (name == "NSET" || name == "ELSET") return member(words);
    if (name == "ELASTIC") return elastic(words);
    if (name == "DENSITY") return density(words);
    if (name == "BOUNDARY") return boundary(words);
    if (name == "CLOAD") return concentrated(words);
    if (name == "DLOAD") return distributed(words);
    return fail(Fault::syntax, 1,
                name.empty() ? "the file must start with a keyword (*NODE ...)" : "*" + name + " takes no data");
  }

  Status node(const std::vector<Word>& words) {
    if (words.size() < 4)
      return fail(at_ >= text_.size() ? Fault::truncated : Fault::syntax, int(current_.size()) + 1,
                  "a node is NUMBER, X, Y, Z; here are " + std::to_string(words.size()) + " words");
    auto label = integer(words[0], "the node's number");
    if (!label) return label.error();
    Eigen::Vector3d position;
    for (int i = 0; i < 3; ++i) {
      auto value = real(words[i + 1], "a coordinate");
      if (!value) return value.error();
      position[i] = *value;
    }
    const int index = int(job_.model.nodes.size());
    if (!node_index_.emplace(*label, index).second)
      return fail(Fault::syntax, words[0].column, "node " + std::to_string(*label) + " is defined twice");
    job_.model.nodes.push_back(position);
    job_.model.node_label.push_back(*label);
    if (set_ != nullptr) set_->push_back(index);
    return success();
  }

  Status element(const std::vector<Word>& words) {
    // an element may take several lines
    for (const Word& word : words) {
      auto value = integer(word, pending_.empty() ? "the element's number" : "a node's number");
      if (!value) return value.error();
      if (pending_.empty()) {
        if (!element_index_.emplace(*value, int(job_.model.hexahedra.size())).second)
          return fail(Fault::syntax, word.column, "element " + std::to_string(*value) + " is defined twice");
        pending_.push_back(*value);
        continue;
      }
      const auto found = node_index_.find(*value);
      if (found == node_index_.end())
        return fail(Fault::unknown, word.column,
                    "element " + std::to_string(pending_[0]) + " names node " + std::to_string(*value) +
                        ", which is not defined");
      pending_.push_back(found->second);
    }
    const std::size_t needed_words = 1 + nodes_of(job_.model.element);
    if (pending_.size() > needed_words)
      return fail(Fault::element, words.back().column,
                  "element " + std::to_string(pending_[0]) + " has " + std::to_string(needed_words - 1) +
                      " nodes, here are " + std::to_string(pending_.size() - 1));
    if (pending_.size() < needed_words) return success();
    Hexahedron h;
    h.material = -1;
    std::copy(pending_.begin() + 1, pending_.end(), h.node.begin());
    if (set_ != nullptr) set_->push_back(int(job_.model.hexahedra.size()));
    job_.model.hexahedra.push_back(h);
    job_.model.hexahedron_label.push_back(pending_[0]);
    pending_.clear();
    return success();
  }

  /// the members that a word names: one by number, or those of a set
  Result<std::vector<int>> members(const Word& word, bool nodes) const {
    const auto& index = nodes ? node_index_ : element_index_;
    const char* what = nodes ? "node" : "element";
    int label = 0;
    const auto [end, problem] = std::from_chars(word.text.data(), word.text.data() + word.text.size(), label);
    if (problem == std::errc() && end == word.text.data() + word.text.size()) {
      const auto found = index.find(label);
      if (found == index.end())
        return fail(Fault::unknown, word.column, std::string(what) + " " + std::to_string(label) + " is not defined");
      return std::vector<int>{found->second};
    }
    const auto& sets = nodes ? job_.node_sets : job_.element_sets;
    const auto found = sets.find(upper(word.text));
    if (found == sets.end())
      return fail(Fault::unknown, word.column,
                  std::string(what) + " set '" + std::string(word.text) + "' is not defined");
    return found->second;
  }

  Status member(const std::vector<Word>& words) {
    const bool nodes = keyword_.name == "NSET";
    if (generate_) {
      if (words.size() < 2) return fail(Fault::syntax, 1, "GENERATE takes FIRST, LAST [, STEP]");
      int range[3] = {0, 0, 1};
      for (std::size_t k = 0; k < std::min<std::size_t>(3, words.size()); ++k) {
        auto value = integer(words[k], "a number");
        if (!value) return value.error();
        range[k] = *value;
      }
      if (range[2] <= 0 || range[1] < range[0])
        return fail(Fault::syntax, 1, "GENERATE needs FIRST <= LAST and a step of at least 1");
      const auto& index = nodes ? node_index_ : element_index_;
      for (long label = range[0]; label <= range[1]; label += range[2])
        if (const auto found = index.find(int(label)); found != index.end()) set_->push_back(found->second);
      return success();
    }
    for (const Word& word : words) {
      if (word.text.empty()) continue;
      auto found = members(word, nodes);
      if (!found) return found.error();
      set_->insert(set_->end(), found->begin(), found->end());
    }
    return success();
  }

  Status elastic(const std::vector<Word>& words) {
    if (rows_ > 1) return fail(Fault::unknown, 1, "*ELASTIC depends on nothing here, one line E, nu is expected");
    if (words.size() < 2) return fail(Fault::syntax, int(current_.size()) + 1, "*ELASTIC needs E, nu");
    auto young = real(words[0], "E"), poisson = real(words[1], "nu");
    if (!young) return young.error();
    if (!poisson) return poisson.error();
    if (*young <= 0)
      return fail(Fault::material, words[0].column, "E must be positive, is " + std::string(words[0].text));
    if (*poisson >= 0.5 || *poisson <= -1)
      return fail(Fault::material, words[1].column, "nu must lie in (-1, 0.5), is " + std::string(words[1].text));
    job_.model.materials.back().young = *young;
    job_.model.materials.back().poisson = *poisson;
    return success();
  }

  Status density(const std::vector<Word>& words) {
    if (words.empty()) return fail(Fault::syntax, 1, "*DENSITY needs a number");
    auto value = real(words[0], "density");
    if (!value) return value.error();
    if (*value < 0) return fail(Fault::material, words[0].column, "density must not be negative");
    job_.model.materials.back().density = *value;
    return success();
  }

  Result<int> axis(const Word& word) const {
    auto value = integer(word, "a direction");
    if (!value) return value;
    if (*value < 1 || *value > 3)
      return fail(Fault::load, word.column, "a solid node has the directions 1 to 3, is " + std::to_string(*value));
    return *value - 1;
  }

  Status boundary(const std::vector<Word>& words) {
    if (words.size() < 2) return fail(Fault::syntax, 1, "*BOUNDARY takes NODE or SET, FIRST [, LAST [, VALUE]]");
    auto targets = members(words[0], true);
    if (!targets) return targets.error();
    auto first = axis(words[1]);
    if (!first) return first.error();
    auto last = words.size() > 2 && !words[2].text.empty() ? axis(words[2]) : first;
    if (!last) return last.error();
    auto value = words.size() > 3 && !words[3].text.empty() ? real(words[3], "a displacement") : Result<double>(0.0);
    if (!value) return value.error();
    loadings_.push_back({true, *targets, *first, *last, *value, -1, {}});
    return success();
  }

  Status concentrated(const std::vector<Word>& words) {
    if (words.size() < 3) return fail(Fault::syntax, 1, "*CLOAD takes NODE or SET, DIRECTION, FORCE");
    auto targets = members(words[0], true);
    if (!targets) return targets.error();
    auto direction = axis(words[1]);
    if (!direction) return direction.error();
    auto value = real(words[2], "a force");
    if (!value) return value.error();
    loadings_.push_back({false, *targets, *direction, *direction, *value, -1, {}});
    return success();
  }

  Status distributed(const std::vector<Word>& words) {
    if (words.size() < 3) return fail(Fault::syntax, 1, "*DLOAD takes ELEMENT or SET, P1..P6 or GRAV, SIZE ...");
    auto targets = members(words[0], false);
    if (!targets) return targets.error();
    auto value = real(words[2], "the size of the load");
    if (!value) return value.error();
    const std::string kind = upper(words[1].text);
    if (kind.size() == 2 && kind[0] == 'P' && kind[1] >= '1' && kind[1] <= '6') {
      loadings_.push_back({false, *targets, 0, 0, *value, kind[1] - '1', {}});
      return success();
    }
    if (kind != "GRAV")
      return fail(Fault::unknown, words[1].column, "a distributed load is P1 to P6 or GRAV, is " + kind);
    if (words.size() < 6) return fail(Fault::syntax, 1, "GRAV takes SIZE and a direction X, Y, Z");
    Eigen::Vector3d direction;
    for (int i = 0; i < 3; ++i) {
      auto part = real(words[3 + i], "a direction");
      if (!part) return part.error();
      direction[i] = *part;
    }
    if (direction.norm() == 0) return fail(Fault::load, words[3].column, "the direction of gravity has no length");
    loadings_.push_back({false, *targets, 0, 0, *value, -2, direction.normalized()});
    return success();
  }

  Status end_card() {
    if (!pending_.empty())
      return fail(at_ >= text_.size() ? Fault::truncated : Fault::element, 1,
                  "element " + std::to_string(pending_[0]) + " ends after " + std::to_string(pending_.size() - 1) +
                      " of " + std::to_string(nodes_of(job_.model.element)) + " nodes");
    if ((keyword_.name == "ELASTIC" || keyword_.name == "DENSITY") && rows_ == 0)
      return fail(at_ >= text_.size() ? Fault::truncated : Fault::syntax, 1, "*" + keyword_.name + " has no data");
    return success();
  }

  Status give_materials() {
    Model& model = job_.model;
    for (const Section& section : sections_) {
      line_ = section.line;
      const auto set = job_.element_sets.find(section.elements);
      if (set == job_.element_sets.end())
        return fail(Fault::unknown, 1,
                    "*SOLID SECTION names the element set " + section.elements + ", which is not defined");
      const auto found = std::find_if(model.materials.begin(), model.materials.end(),
                                      [&](const Material& m) { return m.name == section.material; });
      if (found == model.materials.end())
        return fail(Fault::unknown, 1,
                    "*SOLID SECTION names the material " + section.material + ", which is not defined");
      if (!std::isfinite(found->young))
        return fail(Fault::material, 1, "material " + section.material + " has no *ELASTIC");
      for (int element : set->second) model.hexahedra[element].material = int(found - model.materials.begin());
    }
    for (std::size_t e = 0; e < model.hexahedra.size(); ++e)
      if (model.hexahedra[e].material < 0)
        return Error{Fault::unknown,
                     name_ + ": element " + std::to_string(model.hexahedron_label[e]) + " is in no *SOLID SECTION"};
    // materials that nothing uses need no constants
    for (Material& material : model.materials)
      if (!std::isfinite(material.young)) material.young = 1, material.poisson = 0;
    return success();
  }

  void give_loads() {
    Model& model = job_.model;
    std::vector<int> support_of(model.nodes.size(), -1);
    for (const Loading& loading : loadings_)
      for (int target : loading.targets) {
        if (loading.side >= 0) {
          add_pressure(model, {target, loading.side}, loading.value, job_.load);
        } else if (loading.side == -2) {
          add_gravity(model, target, loading.value * loading.direction, job_.load);
        } else if (!loading.boundary) {
          job_.load(loading.first, target) += loading.value;
        } else {
          if (support_of[target] < 0) {
            support_of[target] = int(model.supports.size());
            Support fresh;
            fresh.node = target;
            fresh.held = {false, false, false};
            model.supports.push_back(fresh);
          }
          Support& support = model.supports[support_of[target]];
          for (int i = loading.first; i <= loading.last; ++i) {
            support.held[i] = true;
            support.shift[i] = loading.value;
          }
        }
      }
  }

  Result<Job> finish() {
    if (in_step_) return fail(Fault::truncated, 1, "the file ends inside *STEP, *END STEP is missing");
    if (job_.model.hexahedra.empty()) return Error{Fault::truncated, name_ + ": has no elements"};
    if (auto status = give_materials(); !status) return status.error();
    job_.load = Field::Zero(3, int(job_.model.nodes.size()));
    give_loads();
    return std::move(job_);
  }

  const std::string& text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 0, card_line_ = 0, rows_ = 0;
  std::string_view current_;
  Keyword keyword_;
  bool skipping_ = false, generate_ = false, in_step_ = false;
  std::vector<int>* set_ = nullptr;
  std::vector<int> pending_;  // the element that is being read: its number, then node indices
  std::unordered_map<int, int> node_index_, element_index_;
  std::vector<Section> sections_;
  std::vector<Loading> loadings_;
  Job job_;
};

}  // namespace

Result<Job> parse_inp(const std::string& text, const std::string& name) { return Reader(text, name).run(); }

Result<Job> read_inp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{Fault::io, path + ": cannot be opened for reading"};
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) return Error{Fault::io, path + ": cannot be read"};
  return parse_inp(text, path);
}

}  // namespace face
