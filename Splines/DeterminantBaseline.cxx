// SPDX-License-Identifier: BSD-3-Clause
#define HYPERPATCH_LANES 2
#define HYPERPATCH_KERNELS DeterminantBaseline
#define HYPERPATCH_KERNELS_NAME "baseline"
#include "DeterminantKernel.inl"
