// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <pkg/common/ElastMat.hpp>

namespace yade {

class MembraneMat : public FrictMat {
public:
    void postLoad(MembraneMat&);
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(MembraneMat, FrictMat,
        "Thin film: :yref:`young<ElastMat.young>` E [Pa] > 0, :yref:`poisson<ElastMat.poisson>` nu [-] in (-1, 0.5], "
        ":yref:`density<Material.density>` rho [kg/m³] > 0 and a thickness. Sides of a :yref:`Membrane` take their stiffness from it, "
        "paper equation (5); the friction angle serves contacts of cable masses with other bodies.",
        ((Real, thickness, 7.5e-6, Attr::triggerPostLoad, "Thickness h of the film [m], > 0."))
        ,
        createIndex();
    );
    // clang-format on
    REGISTER_CLASS_INDEX(MembraneMat, FrictMat);
};
REGISTER_SERIALIZABLE(MembraneMat);

} // namespace yade
