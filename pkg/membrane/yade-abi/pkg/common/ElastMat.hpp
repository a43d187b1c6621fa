// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Material.hpp>

namespace yade {

class ElastMat : public Material {
public:
    Real young;
    Real poisson;

    ElastMat() : young(1e9), poisson(.25) { createIndex(); }
    virtual ~ElastMat();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

class FrictMat : public ElastMat {
public:
    Real frictionAngle;

    FrictMat();
    virtual ~FrictMat();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

YADE_ABI_LAYOUT(ElastMat, 96, ((young, 80))((poisson, 88)));
YADE_ABI_LAYOUT(FrictMat, 104, ((frictionAngle, 96)));
YADE_ABI_SAVED(ElastMat)
YADE_ABI_SAVED(FrictMat)

} // namespace yade
