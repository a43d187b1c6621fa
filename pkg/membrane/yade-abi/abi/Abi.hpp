// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Boost's own headers trip over these two notices.
#ifndef BOOST_BIND_GLOBAL_PLACEHOLDERS
#define BOOST_BIND_GLOBAL_PLACEHOLDERS
#endif
#ifndef BOOST_ALLOW_DEPRECATED_HEADERS
#define BOOST_ALLOW_DEPRECATED_HEADERS
#endif

// Python.h must precede every standard header.
#include <boost/python/detail/wrap_python.hpp>

#include <boost/preprocessor.hpp>
#include <cstddef>
#include <string>

// What the layout of Debian's libyade rests on, as far as a compiler can be asked.
#ifndef YADE_ABI_RELEASE
#error "Compile with -DYADE_ABI_RELEASE=<column abi of yade-abi/releases.txt>, of the YADE that will load this."
#endif
#if !defined(EIGEN_DONT_ALIGN) && !defined(EIGEN_DONT_VECTORIZE)
#error "Compile with -DEIGEN_DONT_ALIGN: Debian's YADE does not align Eigen types, and State would differ in size."
#endif
#if !defined(__x86_64__) || !defined(__linux__)
#error "These declarations describe Debian's amd64 build of YADE only."
#endif
#if !_GLIBCXX_USE_CXX11_ABI
#error "Debian's YADE uses the new string ABI: compile with _GLIBCXX_USE_CXX11_ABI=1, the default."
#endif
#if defined(YADE_REAL_BIT) && YADE_REAL_BIT != 64
#error "These declarations describe the build of YADE whose Real is double."
#endif

namespace yade {
namespace abi {
// Specialised by YADE_ABI_LAYOUT; a class befriends its own one to have private members checked.
template <class Class> struct Layout;
} // namespace abi
} // namespace yade

// YADE_ABI_LAYOUT(Class, size, ((member, offset))((member, offset))...), used in namespace yade.
// offsetof is only conditionally supported for such classes; g++ and clang++ do support it.
#define YADE_ABI_LAYOUT(Class, size, offsets)                                                                          \
    _Pragma("GCC diagnostic push");                                                                                    \
    _Pragma("GCC diagnostic ignored \"-Winvalid-offsetof\"");                                                          \
    template <> struct abi::Layout<Class> {                                                                            \
        using Checked = Class;                                                                                         \
        static_assert(sizeof(Class) == (size), "size of " #Class " differs from YADE's");                              \
        BOOST_PP_SEQ_FOR_EACH(YADE_ABI_OFFSET, ~, offsets)                                                             \
    };                                                                                                                 \
    _Pragma("GCC diagnostic pop") static_assert(true, "")
#define YADE_ABI_OFFSET(r, data, pair) YADE_ABI_OFFSET_OF pair
#define YADE_ABI_OFFSET_OF(member, offset)                                                                             \
    static_assert(offsetof(Checked, member) == (offset), "offset of " #member " differs from YADE's");

// A class derived from Class starts with its first member at `offset`, within padding that sizeof(Class) counts.
#define YADE_ABI_TAIL(Class, offset)                                                                                   \
    namespace abi {                                                                                                    \
    struct After##Class : Class { /* NOLINT(bugprone-macro-parentheses): a base takes none */                          \
        char first;                                                                                                    \
    };                                                                                                                 \
    }                                                                                                                  \
    YADE_ABI_LAYOUT(abi::After##Class, sizeof(Class), ((first, offset)))
