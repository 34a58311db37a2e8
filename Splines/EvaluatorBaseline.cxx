// SPDX-License-Identifier: BSD-3-Clause
#define HYPERPATCH_LANES 2
#define HYPERPATCH_KERNELS EvaluatorBaseline
#define HYPERPATCH_KERNELS_NAME "baseline"
#include "EvaluatorKernel.inl"
