#include "manipulators/face_fem/blas_setup.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

// present in OpenBLAS only; another BLAS leaves them null
extern "C" {
__attribute__((weak)) char* openblas_get_corename();
__attribute__((weak)) void openblas_set_num_threads(int);
}

namespace face {
namespace {

bool has_avx512() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

}  // namespace

const char* blas_kernels() { return openblas_get_corename != nullptr ? openblas_get_corename() : "unknown"; }

void prepare_blas(char** argv) {
  const std::string_view kernels = blas_kernels();
  const bool behind = kernels == "Haswell" || kernels == "Zen";
  if (behind && has_avx512() && std::getenv("OPENBLAS_CORETYPE") == nullptr) {
    setenv("OPENBLAS_CORETYPE", "SkylakeX", 1);
    // returns only when it cannot; then the kernels at hand do as well
    execv("/proc/self/exe", argv);
  }
  if (openblas_set_num_threads != nullptr && std::getenv("OPENBLAS_NUM_THREADS") == nullptr)
    openblas_set_num_threads(1);
}

}  // namespace face
