// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"
#include <core/Dispatching.hpp>
#include <pkg/common/NormShearPhys.hpp>

namespace yade {

/// Spring of one side. A NormShearPhys, since YADE's own analyses take every interaction for one.
class MembranePhys : public NormShearPhys {
public:
    explicit MembranePhys(const ::membrane::Side& side) : MembranePhys() { set(side); }
    void set(const ::membrane::Side& side) {
        kn = side.stiffness;
        restLength = side.restLength;
        criticalLength = side.critical;
    }
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(MembranePhys, NormShearPhys,
        "Spring of one side of a :yref:`Membrane`: stiffness :yref:`kn<NormPhys.kn>` k [N/m] and the lengths of paper equations (3), (6). "
        ":yref:`normalForce<NormPhys.normalForce>` [N] follows YADE: along the normal in compression, against it in tension.",
        ((Real, unusedFriction, 0., (Attr::hidden | Attr::noSave), "Not used [-]. It lies where YADE's setContactFriction, which takes every interaction for a FrictPhys, writes."))
        ((Real, restLength, 0., , "Rest length L0 [m]."))
        ((Real, criticalLength, 0., , "Length l_cr [m] below which the side is buckled and its force constant."))
        ,
        // No shear, but YADE's energy helpers divide by ks; one so small does not weigh in its time steppers.
        ks = 1e-200;
        createIndex();
    );
    // clang-format on
    REGISTER_CLASS_INDEX(MembranePhys, NormShearPhys);
};
REGISTER_SERIALIZABLE(MembranePhys);

class Ip2_MembraneMat_MembraneMat_MembranePhys : public IPhysFunctor {
public:
    void go(const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>& link) override;
    FUNCTOR2D(MembraneMat, MembraneMat);
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS(Ip2_MembraneMat_MembraneMat_MembranePhys, IPhysFunctor,
        "Gives a side of the membrane its spring. Sides made by :yref:`Membrane.addInteractions` have it already.",
        ((shared_ptr<Membrane>, membrane, , , "The membrane whose sides get springs."))
    );
    // clang-format on
};
REGISTER_SERIALIZABLE(Ip2_MembraneMat_MembraneMat_MembranePhys);

} // namespace yade
