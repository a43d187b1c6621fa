// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/IPhys.hpp>

namespace yade {

// Forces are those on body 2, after the previous step.
class NormPhys : public IPhys {
public:
    Real kn;
    Vector3r normalForce;

    NormPhys();
    virtual ~NormPhys();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

class NormShearPhys : public NormPhys {
public:
    Real ks;
    Vector3r shearForce;

    NormShearPhys();
    virtual ~NormShearPhys();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

YADE_ABI_LAYOUT(NormPhys, 64, ((kn, 32))((normalForce, 40)));
YADE_ABI_LAYOUT(NormShearPhys, 96, ((ks, 64))((shearForce, 72)));
YADE_ABI_SAVED(NormPhys)
YADE_ABI_SAVED(NormShearPhys)

} // namespace yade
