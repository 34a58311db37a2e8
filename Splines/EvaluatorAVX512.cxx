// SPDX-License-Identifier: BSD-3-Clause
#define HYPERPATCH_LANES 8
#define HYPERPATCH_KERNELS EvaluatorAVX512
#define HYPERPATCH_KERNELS_NAME "avx512"
#include "EvaluatorKernel.inl"
