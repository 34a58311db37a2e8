// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Error_h
#define hyperpatch_Error_h

#include <stdexcept>
#include <string>

namespace hyperpatch
{

/// Thrown by every constructor and function of the kernel whose documented precondition fails.
/// The text names the thing that is wrong and, where there is one, the remedy.
class Error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

}

#endif
