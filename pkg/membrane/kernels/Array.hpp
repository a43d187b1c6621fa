// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <cstddef>
#include <vector>

namespace membrane {

/// Memory for the arrays of the kernels. A kernel walks through a dozen of them side by side; were all equally far from
/// a page's start, as those of the same size usually are, they would drive one another out of the first-level cache. So
/// each begins at another place in its page. Large ones lie in huge pages where the system allows it.
void* allocateArray(std::size_t bytes);
void releaseArray(void* data) noexcept;

template <class Value> struct ArrayAllocator {
    using value_type = Value;
    ArrayAllocator() = default;
    template <class Other> ArrayAllocator(const ArrayAllocator<Other>&) {}
    Value* allocate(std::size_t count) { return static_cast<Value*>(allocateArray(count * sizeof(Value))); }
    void deallocate(Value* data, std::size_t) noexcept { releaseArray(data); }
    template <class Other> bool operator==(const ArrayAllocator<Other>&) const { return true; }
    template <class Other> bool operator!=(const ArrayAllocator<Other>&) const { return false; }
};

using Array = std::vector<double, ArrayAllocator<double>>;

} // namespace membrane
