// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The first include of a kernel's source. Loops become vectors only if nobody asks for errno or traps; without fused
// multiply-add all CPUs give the same digits. Set here, and not by CMake, since a YADE tree compiles with flags of its
// own. What was read before keeps those, and would not be inlined into what follows: where other sources may come
// before, in a unity build, the kernels do without, and their loops remain scalar. A YADE tree with loggers leaves
// sources that speak of a CREATE_CPP_LOCAL_LOGGER out of its unity builds.
#if defined(__GNUC__) && !defined(__clang__) && !defined(_GLIBCXX_CXX_CONFIG_H)
#pragma GCC optimize("no-math-errno", "no-trapping-math", "fp-contract=off")
#endif
