// SPDX-License-Identifier: GPL-2.0-or-later
#include "Array.hpp"
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sys/mman.h>

namespace membrane {
namespace {

constexpr std::size_t page = 4096, hugePage = std::size_t(1) << 21;
constexpr std::size_t line = 64;         ///< of the cache
constexpr std::size_t stride = 5 * line; ///< between the places of successive arrays in their pages; odd in lines

std::atomic<std::size_t> allocated{0};

/// What lies right before the data.
struct Header {
    void* block;
    std::size_t mapped; ///< bytes; 0: from malloc
};
static_assert(sizeof(Header) <= line);

} // namespace

void* allocateArray(std::size_t bytes) {
    const std::size_t place = line + allocated++ % (page / stride - 1) * stride;
    Header header{nullptr, 0};
    char* begin = nullptr;
    if (bytes >= 2 * hugePage) { // fresh memory, since pages that were touched before are no longer made huge
        header.mapped = place + bytes + hugePage;
        header.block = mmap(nullptr, header.mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (header.block == MAP_FAILED) throw std::bad_alloc();
        begin =
            static_cast<char*>(header.block) + (hugePage - reinterpret_cast<std::uintptr_t>(header.block) % hugePage);
        madvise(begin, place + bytes, MADV_HUGEPAGE); // a wish: it may not be granted
    } else {
        if (posix_memalign(&header.block, page, place + bytes) != 0) throw std::bad_alloc();
        begin = static_cast<char*>(header.block);
    }
    char* const data = begin + place;
    std::memcpy(data - sizeof header, &header, sizeof header);
    return data;
}

void releaseArray(void* data) noexcept {
    Header header;
    std::memcpy(&header, static_cast<char*>(data) - sizeof header, sizeof header);
    if (header.mapped)
        munmap(header.block, header.mapped);
    else
        std::free(header.block);
}

} // namespace membrane
