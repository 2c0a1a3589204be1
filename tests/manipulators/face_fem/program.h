#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <Eigen/Core>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

// Runs programs and reads the tables of displacements that they write.
namespace face::program {

/// What a program said and how it ended.
struct Finished {
  int status;
  std::string text;  // both streams
};

inline Finished run(const std::string& command) {
  Finished result{-1, ""};
  std::FILE* pipe = popen((command + " 2>&1 </dev/null").c_str(), "r");
  char buffer[4096];
  for (std::size_t got; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) result.text.append(buffer, got);
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/// A test with a folder of its own, removed at the end.
class InFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("face_fem_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  std::string program() const { return BIN_DIR "/face_fem"; }

  std::filesystem::path folder_;
};

/// nodes and displacements of a table `node,ux_m,uy_m,uz_m...`
inline std::map<int, Eigen::Vector3d> displacements(const std::string& path) {
  std::map<int, Eigen::Vector3d> u;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    int node = 0;
    Eigen::Vector3d v;
    EXPECT_EQ(std::sscanf(line.c_str(), "%d,%lf,%lf,%lf", &node, &v.x(), &v.y(), &v.z()), 4) << line;
    u[node] = v;
  }
  return u;
}

/// The same from a table that CalculiX prints (*NODE PRINT).
inline std::map<int, Eigen::Vector3d> printed(const std::string& path) {
  std::map<int, Eigen::Vector3d> u;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    int node = 0;
    Eigen::Vector3d v;
    if (words >> node >> v.x() >> v.y() >> v.z()) u[node] = v;
  }
  return u;
}

/// |u - v| / |v| over the nodes of v, all of which u must have.
inline double difference(const std::map<int, Eigen::Vector3d>& u, const std::map<int, Eigen::Vector3d>& v) {
  double apart = 0, size = 0;
  for (const auto& [node, value] : v) {
    apart += (value - u.at(node)).squaredNorm();
    size += value.squaredNorm();
  }
  return std::sqrt(apart / size);
}

inline bool has_calculix() { return std::system("command -v ccx >/dev/null") == 0; }

}  // namespace face::program
