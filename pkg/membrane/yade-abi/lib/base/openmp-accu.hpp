// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/base/Math.hpp>

namespace yade {

// One row of T per OpenMP thread; the value of an element is its sum over the threads.
template <typename T> class OpenMPArrayAccumulator {
    int cacheLine;
    size_t threads;
    int perCacheLine;
    vector<T*> rows;
    size_t length;
    size_t cacheLines;
    friend struct abi::Layout<OpenMPArrayAccumulator<T>>;

public:
    size_t size() const { return length; }
    T operator[](size_t i) const { return get(i); }
    T get(size_t i) const {
        T sum = 0;
        for (const T* row : rows) sum += row[i];
        return sum;
    }
    // not from parallel sections
    void set(size_t i, const T& value) {
        for (T* row : rows) row[i] = 0;
        rows[0][i] = value;
    }
};

YADE_ABI_LAYOUT(OpenMPArrayAccumulator<Real>, 64,
                ((cacheLine, 0))((threads, 8))((perCacheLine, 16))((rows, 24))((length, 48))((cacheLines, 56)));

} // namespace yade
