// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Bound : public Serializable, public Indexable {
public:
    int lastUpdateIter;
    Vector3r refPos;
    Real sweepLength;
    Vector3r color;
    Vector3r min;
    Vector3r max;

    Bound()
        : lastUpdateIter(0), refPos(NaN, NaN, NaN), sweepLength(0), color(1, 1, 1), min(NaN, NaN, NaN),
          max(NaN, NaN, NaN) {}
    virtual ~Bound();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_TOP_INDEXABLE
};

YADE_ABI_LAYOUT(Bound, 144,
                ((lastUpdateIter, 32))((refPos, 40))((sweepLength, 64))((color, 72))((min, 96))((max, 120)));
YADE_ABI_SAVED(Bound)

} // namespace yade
