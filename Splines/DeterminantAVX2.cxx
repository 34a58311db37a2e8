// SPDX-License-Identifier: BSD-3-Clause
#define HYPERPATCH_LANES 4
#define HYPERPATCH_KERNELS DeterminantAVX2
#define HYPERPATCH_KERNELS_NAME "avx2"
#include "DeterminantKernel.inl"
