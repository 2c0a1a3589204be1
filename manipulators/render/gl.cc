#include "manipulators/render/gl.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glcorearb.h>

#include <cstddef>

namespace render::gl {

namespace {

GLuint compiled(GLenum kind, const std::string& source, std::string& problem) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (!good) {
    char log[2000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    problem = std::string("shader: ") + log;
  }
  return shader;
}

}  // namespace

Program::Program(const std::string& vertex, const std::string& fragment, std::string& problem) {
  const GLuint v = compiled(GL_VERTEX_SHADER, vertex, problem);
  const GLuint f = compiled(GL_FRAGMENT_SHADER, fragment, problem);
  id_ = glCreateProgram();
  glAttachShader(id_, v);
  glAttachShader(id_, f);
  glLinkProgram(id_);
  glDeleteShader(v);
  glDeleteShader(f);
  GLint good = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (!good) {
    if (problem.empty()) {
      char log[2000] = "";
      glGetProgramInfoLog(id_, sizeof log, nullptr, log);
      problem = std::string("shader: ") + log;
    }
    return;
  }
  const GLuint block = glGetUniformBlockIndex(id_, "Frame");
  if (block != GL_INVALID_INDEX) glUniformBlockBinding(id_, block, 0);
  glUseProgram(id_);
  const char* samplers[] = {"shadow_map", "occlusion_map", "color_map", "geometry_map"};
  for (int unit = 0; unit < 4; ++unit) {
    const GLint where = glGetUniformLocation(id_, samplers[unit]);
    if (where >= 0) glUniform1i(where, unit);
  }
}

Program::~Program() { glDeleteProgram(id_); }

void Program::use() const { glUseProgram(id_); }

int Program::location(const char* name) {
  auto [entry, is_new] = locations_.try_emplace(name, -1);
  if (is_new) entry->second = glGetUniformLocation(id_, name);
  return entry->second;
}

void Program::set(const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, value.data());
}

void Program::set(const char* name, const Eigen::Matrix3f& value) {
  glUniformMatrix3fv(location(name), 1, GL_FALSE, value.data());
}

void Program::set(const char* name, const Eigen::Vector4f& value) { glUniform4fv(location(name), 1, value.data()); }

Image::Image(Kind kind, Size size) : kind_(kind), size_(size) {
  struct Format {
    GLint inner;
    GLenum format, type;
    GLint filter;
  };
  // in the order of Kind
  static constexpr Format formats[] = {
      {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR},
      {GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_NEAREST},
      {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, GL_NEAREST},
      {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, GL_LINEAR},
      {GL_R8, GL_RED, GL_UNSIGNED_BYTE, GL_LINEAR},
  };
  const Format& f = formats[static_cast<int>(kind)];
  glGenTextures(1, &id_);
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexImage2D(GL_TEXTURE_2D, 0, f.inner, size.width, size.height, 0, f.format, f.type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, f.filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, f.filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  if (kind == Kind::shadow) {
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }
}

Image::~Image() { glDeleteTextures(1, &id_); }

void Image::bind(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, id_);
}

Target::Target(std::initializer_list<const Image*> images) {
  glGenFramebuffers(1, &frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  std::vector<GLenum> colors;
  for (const Image* image : images) {
    const bool is_depth = image->kind() == Image::Kind::depth || image->kind() == Image::Kind::shadow;
    const GLenum place = is_depth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(colors.size());
    if (!is_depth) colors.push_back(place);
    glFramebufferTexture2D(GL_FRAMEBUFFER, place, GL_TEXTURE_2D, image->id(), 0);
    size_ = image->size();
  }
  if (colors.empty()) colors.push_back(GL_NONE);
  glDrawBuffers(static_cast<GLsizei>(colors.size()), colors.data());
  glReadBuffer(colors[0]);
  complete_ = glGetError() == GL_NO_ERROR && glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

Target::~Target() { glDeleteFramebuffers(1, &frame_); }

void Target::use() const {
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glViewport(0, 0, size_.width, size_.height);
}

Store::~Store() { age(-1); }

void Store::bind(const Geometry& geometry) {
  Entry& entry = entries_[geometry.id];
  entry.last_use = now_;
  bound_ = &entry;
  if (!entry.array) {
    glGenVertexArrays(1, &entry.array);
    glGenBuffers(1, &entry.vertices);
    glGenBuffers(1, &entry.indices);
    glBindVertexArray(entry.array);
    glBindBuffer(GL_ARRAY_BUFFER, entry.vertices);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, entry.indices);
    auto attribute = [](GLuint slot, GLint size, GLenum type, GLboolean normalized, std::size_t offset) {
      glEnableVertexAttribArray(slot);
      glVertexAttribPointer(slot, size, type, normalized, sizeof(Vertex), reinterpret_cast<const void*>(offset));
    };
    attribute(0, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, position));
    attribute(1, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, normal));
    attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, color));
  } else {
    glBindVertexArray(entry.array);
  }
  if (entry.generation != geometry.generation) {
    glBindBuffer(GL_ARRAY_BUFFER, entry.vertices);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(geometry.vertices.size() * sizeof(Vertex)),
                 geometry.vertices.data(), entry.generation ? GL_STREAM_DRAW : GL_STATIC_DRAW);
    entry.generation = geometry.generation;
  }
  if (entry.topology != geometry.topology) {
    std::vector<std::uint32_t> all;
    entry.level_starts.clear();
    for (const Level& level : geometry.levels) {
      entry.level_starts.push_back(all.size());
      all.insert(all.end(), level.indices.begin(), level.indices.end());
    }
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(all.size() * sizeof(std::uint32_t)), all.data(),
                 GL_STATIC_DRAW);
    entry.topology = geometry.topology;
  }
}

void Store::draw(const Geometry& geometry, std::size_t level, const Span& span) const {
  const std::size_t first = (bound_->level_starts[level] + span.first) * sizeof(std::uint32_t);
  glDrawRangeElements(geometry.primitive == Primitive::lines ? GL_LINES : GL_TRIANGLES, 0,
                      static_cast<GLuint>(geometry.vertices.size() - 1), static_cast<GLsizei>(span.count),
                      GL_UNSIGNED_INT, reinterpret_cast<const void*>(first));
}

void Store::draw(const Geometry& geometry, std::size_t level) const {
  draw(geometry, level, {0, static_cast<std::uint32_t>(geometry.levels[level].indices.size()), 0});
}

void Store::age(int frames) {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    if (now_ - entry->second.last_use > frames) {
      glDeleteVertexArrays(1, &entry->second.array);
      glDeleteBuffers(1, &entry->second.vertices);
      glDeleteBuffers(1, &entry->second.indices);
      entry = entries_.erase(entry);
    } else {
      ++entry;
    }
  }
  ++now_;
}

}  // namespace render::gl
