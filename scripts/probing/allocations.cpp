// SPDX-License-Identifier: GPL-2.0-or-later
// Preloaded by `scripts/run.sh probe`: remembers what YADE asks operator new for, which tells the sizes of its classes.
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {
constexpr std::size_t kept = 1 << 16;
struct Block {
    void* place;
    std::size_t size;
} blocks[kept];
std::size_t count = 0;
} // namespace

void* operator new(std::size_t size) {
    void* const place = std::malloc(size ? size : 1);
    if (!place) throw std::bad_alloc();
    blocks[count++ % kept] = {place, size};
    return place;
}

/// Bytes asked for at a place, the last time; 0 if none are known.
extern "C" std::size_t membrane_allocated(const void* place) {
    for (std::size_t back = 1; back <= kept && back <= count; ++back)
        if (const Block& block = blocks[(count - back) % kept]; block.place == place) return block.size;
    return 0;
}
