// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Dispatching.hpp>
#include <pkg/common/ElastMat.hpp>
#include <pkg/common/NormShearPhys.hpp>

namespace yade {

class FrictPhys : public NormShearPhys {
public:
    Real tangensOfFrictionAngle;
#if YADE_ABI_RELEASE >= 202601
    Real frictDissip;
#endif

    FrictPhys();
    virtual ~FrictPhys();
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

#if YADE_ABI_RELEASE >= 202601
YADE_ABI_LAYOUT(FrictPhys, 112, ((tangensOfFrictionAngle, 96))((frictDissip, 104)));
#else
YADE_ABI_LAYOUT(FrictPhys, 104, ((tangensOfFrictionAngle, 96)));
#endif
YADE_ABI_SAVED(FrictPhys)

} // namespace yade
