// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Coordinates.hpp"
#include <initializer_list>

namespace membrane {

/// Fetches what the next chunk will need into the cache, a little with each block of this chunk: the CPU's own
/// prefetching starts anew on every page of memory, and a chunk is about a page of each array.
class Prefetch {
public:
    /// \param blocks over which the work is spread
    void start(int blocks) {
        blocks_ = std::max(1, blocks);
        count_ = 0;
    }
    /// Values begin..end-1 of an array.
    void add(const double* array, int begin, int end) {
        if (begin < end && count_ < most) ranges_[count_++] = {array + begin, array + end, (end - begin) / blocks_ + 1};
    }
    void add(const Components& c, int begin, int end) {
        for (const double* array : {c.x, c.y, c.z}) add(array, begin, end);
    }
    void next() {
        constexpr int line = 8; // values in a cache line
        for (int k = 0; k < count_; ++k) {
            Range& r = ranges_[k];
            const double* const stop = std::min(r.at + r.step, r.end);
            for (; r.at < stop; r.at += line) __builtin_prefetch(r.at, 1, 2);
        }
    }

private:
    static constexpr int most = 16;
    struct Range {
        const double *at, *end;
        int step;
    };
    Range ranges_[most];
    int count_ = 0, blocks_ = 1;
};

} // namespace membrane
