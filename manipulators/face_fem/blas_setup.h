#pragma once

namespace face {

/// Called first in main. OpenBLAS runs on one thread unless OPENBLAS_NUM_THREADS says otherwise: one thread gives the
/// same bits on every run, and a solve is limited by memory bandwidth anyway. An OpenBLAS older than the processor
/// falls back to AVX2 kernels; where it does so on a processor with AVX-512 (F, DQ, BW, VL), this program starts
/// itself again with OPENBLAS_CORETYPE=SkylakeX, which made factoring a third quicker. A core type that the user has
/// set stays.
void prepare_blas(char** argv);

/// The kernels in use ("SkylakeX", "Haswell" ...), or "unknown" with another BLAS.
const char* blas_kernels();

}  // namespace face
